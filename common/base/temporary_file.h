// TemporaryFile: a file without a name, in the folder for temporary files (TMPDIR). It ends with the process, however
// that ends.
#pragma once

#include <string>
#include <utility>

#include "common/base/file.h"
#include "troupe/result.h"

namespace troupe {

class TemporaryFile {
 public:
  static Result<TemporaryFile> Create();

  // By which this process can open it while the object exists.
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_.get()); }

 private:
  explicit TemporaryFile(FileDescriptor file) : file_(std::move(file)) {}

  FileDescriptor file_;
};

}  // namespace troupe
