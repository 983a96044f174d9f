#include "common/base/temporary_file.h"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace troupe {

Result<TemporaryFile> TemporaryFile::Create() {
  std::error_code no_folder;
  std::string path = (std::filesystem::temp_directory_path(no_folder) / "troupe-XXXXXX").string();
  FileDescriptor file(mkostemp(path.data(), O_CLOEXEC));
  if (file.get() < 0) {
    return Error{{path}, std::string("cannot create a temporary file: ") + std::strerror(errno), ErrorCode::kFailure};
  }
  unlink(path.c_str());
  return TemporaryFile(std::move(file));
}

}  // namespace troupe
