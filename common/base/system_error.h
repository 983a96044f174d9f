// The error of a call of the operating system.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>

#include "troupe/result.h"

namespace troupe {

// "doing: No space left on device", as errno says. `path`: the file of the call; empty if there is none, or if `doing`
// names it. REQUIRES: the last call of the system failed.
inline Error SystemError(const std::string& doing, const std::string& path = "", ErrorCode code = ErrorCode::kFailure) {
  const int failure = errno;
  return {{path}, doing + ": " + std::strerror(failure), code};
}

}  // namespace troupe
