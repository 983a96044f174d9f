#include "common/base/enclave.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace troupe {
namespace {

// Empty if the file can be read.
std::string Fault(const std::string& path) {
  // A named pipe would block without O_NONBLOCK.
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return std::strerror(errno);
  struct stat status {};
  const bool known = fstat(file, &status) == 0;
  close(file);
  if (!known || !S_ISREG(status.st_mode)) return "not a file";
  return status.st_size == 0 ? "empty" : "";
}

}  // namespace

Status CheckEnclave(const std::string& folder) {
  std::error_code failure;
  if (!std::filesystem::is_directory(folder, failure)) {
    return Error{{folder}, "found no such folder, expected the keys of a participant"};
  }
  for (const char* name : kEnclaveFiles) {
    const std::string path = (std::filesystem::path(folder) / name).string();
    if (const std::string fault = Fault(path); !fault.empty()) {
      return Error{{path}, "cannot read a file of the folder of keys: " + fault};
    }
  }
  return {};
}

}  // namespace troupe
