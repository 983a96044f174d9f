// TemporaryFile: a file without a name, in the folder for temporary files (TMPDIR). It ends with the process, however
// that ends.
#pragma once

#include <string>

#include "troupe/result.h"

namespace troupe {

class TemporaryFile {
 public:
  static Result<TemporaryFile> Create();
  ~TemporaryFile();
  TemporaryFile(TemporaryFile&& other) noexcept;
  TemporaryFile& operator=(TemporaryFile&& other) noexcept;

  // By which this process can open it while the object exists.
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  explicit TemporaryFile(int descriptor) : descriptor_(descriptor) {}

  int descriptor_;  // -1: moved from
};

}  // namespace troupe
