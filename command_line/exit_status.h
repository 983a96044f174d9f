// Exit statuses of all programs.
#pragma once

#include "troupe/result.h"

namespace troupe {

inline constexpr int kExitDone = 0;
inline constexpr int kExitBadInput = 2;  // of files or usage
inline constexpr int kExitFailed = 3;
inline constexpr int kExitOutputFailed = 4;  // of an agent whose output file cannot be written (a full disk)
inline constexpr int kExitInterrupted = 130;

// Of a program that ends with this error.
inline int ExitStatusOf(const Error& error) {
  const bool is_bad_input = error.code == ErrorCode::kBadInput || error.code == ErrorCode::kMalformed;
  return is_bad_input ? kExitBadInput : kExitFailed;
}

}  // namespace troupe
