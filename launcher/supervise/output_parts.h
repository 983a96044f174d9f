// OutputParts: files for the parts of one output, written by child processes. They have no name in any folder, so
// nothing is left of them however this process ends; other processes open them through /proc during its lifetime.
#pragma once

#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

class OutputParts {
 public:
  // The parts are in the file system of `output`, the file into which they are merged, or in that of temporary files if
  // `output` is not a regular file. `option`: for error messages.
  OutputParts(const std::string& output, const std::string& option);
  ~OutputParts();
  OutputParts(const OutputParts&) = delete;
  OutputParts& operator=(const OutputParts&) = delete;

  // Adds an empty file and returns its path.
  Result<std::string> Add();

 private:
  std::string folder_;
  std::string option_;
  std::vector<int> descriptors_;
};

}  // namespace troupe
