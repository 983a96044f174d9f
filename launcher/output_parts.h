// OutputParts: files of this process that its children write their parts of one output into. They have no name in any
// folder, so nothing is left of them however this process ends; others reach them through /proc for as long as it
// lives.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.h"

namespace troupe {

class OutputParts {
 public:
  // The space is taken where `output` is, the file that they are merged into, or where temporary files are if that is
  // no file.
  // `option`: for error messages.
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
