// RunEnd: how a run ended, in one process or in many.
#pragma once

#include <optional>
#include <utility>

#include "command_line/exit_status.h"
#include "launcher/supervise/summary.h"
#include "troupe/result.h"

namespace troupe {

struct RunEnd {
  int exit_status = kExitDone;
  std::optional<RunOutcome> outcome;  // of a run that began and did not fail
  std::optional<Error> error;         // to be printed; a failed run without it: a child process has printed the error
};

// The exit status follows from the error.
inline RunEnd FailedRun(Error error) {
  const int exit_status = ExitStatusOf(error);
  return {exit_status, std::nullopt, std::move(error)};
}

}  // namespace troupe
