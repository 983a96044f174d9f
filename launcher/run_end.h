// RunEnd: how a run ended, whichever way it was run.
#pragma once

#include <optional>

#include "common/base/result.h"
#include "launcher/summary.h"

namespace troupe {

// Exit statuses of all programs.
inline constexpr int kExitDone = 0;
inline constexpr int kExitBadInput = 2;
inline constexpr int kExitFailed = 3;
inline constexpr int kExitInterrupted = 130;

struct RunEnd {
  int exit_status = kExitDone;
  std::optional<RunOutcome> outcome;  // of a run that began
  std::optional<Error> error;         // still to be told to the user
};

}  // namespace troupe
