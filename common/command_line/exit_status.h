// Exit statuses of all programs.
#pragma once

namespace troupe {

inline constexpr int kExitDone = 0;
inline constexpr int kExitBadInput = 2;  // of files or usage
inline constexpr int kExitFailed = 3;
inline constexpr int kExitInterrupted = 130;

}  // namespace troupe
