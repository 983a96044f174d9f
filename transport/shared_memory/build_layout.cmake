# Writes OUTPUT, a header with a number of HEADERS (files, in any order) and COMPILER (text).
list(SORT HEADERS)
set(all "${COMPILER}")
foreach(header IN LISTS HEADERS)
  file(SHA256 ${header} hash)
  string(APPEND all " ${hash}")
endforeach()
string(SHA256 hash "${all}")
string(SUBSTRING ${hash} 0 16 number)
file(WRITE ${OUTPUT} "#pragma once

#include <cstdint>

namespace troupe {

inline constexpr std::uint64_t kBuildLayout = 0x${number};

}  // namespace troupe
")
