// Helpers of the fuzz targets.
#pragma once

#include <cstdlib>
#include <string>

#include "fuzz/targets.h"

namespace troupe::fuzz {

// Stops the program, which is a finding.
inline void Check(bool holds) {
  if (!holds) std::abort();
}

inline std::string TextOf(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace troupe::fuzz
