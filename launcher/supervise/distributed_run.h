// `troupe run` over DDS: a world service and its agents, a process each.
#pragma once

#include "launcher/supervise/run_options.h"
#include "launcher/supervise/summary.h"

namespace troupe {

// Starts, supervises and terminates all processes; none is left when it returns.
RunEnd RunDistributed(const RunOptions& options);

}  // namespace troupe
