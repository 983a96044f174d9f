// `troupe run` over DDS: a world service and its agents, a process each.
#pragma once

#include "launcher/run_end.h"
#include "launcher/run_options.h"

namespace troupe {

// Starts, watches and ends all processes; none is left when it returns.
RunEnd RunDistributed(const RunOptions& options);

}  // namespace troupe
