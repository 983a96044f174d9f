// RunEnd: how a run ended, whichever way it was run.
#pragma once

#include <optional>

#include "common/base/result.h"
#include "common/command_line/exit_status.h"
#include "launcher/summary.h"

namespace troupe {

struct RunEnd {
  int exit_status = kExitDone;
  std::optional<RunOutcome> outcome;  // of a run that began
  std::optional<Error> error;         // still to be told to the user
};

}  // namespace troupe
