// `troupe run`: a world service and its agents, from start to summary.
#pragma once

#include "launcher/run_options.h"

namespace troupe {

// Returns the exit status; has told the user what happened.
int RunCommand(RunOptions options);

}  // namespace troupe
