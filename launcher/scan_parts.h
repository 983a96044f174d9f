// ScanParts: files of this process that its agents write their scans into. They have no name in any folder, so nothing
// is left of them however this process ends; others reach them through /proc for as long as it lives.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.h"

namespace troupe {

class ScanParts {
 public:
  // The space is taken where `output` is, the file that they are merged into, or where temporary files are if that is
  // no file.
  explicit ScanParts(const std::string& output);
  ~ScanParts();
  ScanParts(const ScanParts&) = delete;
  ScanParts& operator=(const ScanParts&) = delete;

  // Adds an empty file and returns its path.
  Result<std::string> Add();

 private:
  std::string folder_;
  std::vector<int> descriptors_;
};

}  // namespace troupe
