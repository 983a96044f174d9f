#include "library/write_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace troupe {

Status WritePicture(const std::string& path, const std::string& bytes) {
  const auto failure = [&] {
    return Error{{path, 0, 0}, std::string("cannot write: ") + std::strerror(errno), ErrorCode::kFailure};
  };
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return failure();
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  const bool closed = std::fclose(file) == 0;
  if (!written || !closed) return failure();
  return {};
}

}  // namespace troupe
