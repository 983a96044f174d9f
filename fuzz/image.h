// MemoryFile: a file without a disk, for readers that take a path.
#pragma once

#include <string>

#include "fuzz/targets.h"

namespace troupe::fuzz {

class MemoryFile {
 public:
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const;
  // Replaces the content.
  void Write(Bytes bytes) const;

 private:
  int descriptor_;
};

}  // namespace troupe::fuzz
