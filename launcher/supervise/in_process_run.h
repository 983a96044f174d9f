// `troupe run --in-process`: service and agents in this process, over memory instead of DDS. It runs the same code, so
// every state hash is the same.
#pragma once

#include "launcher/supervise/run_end.h"
#include "launcher/supervise/run_options.h"

namespace troupe {

RunEnd RunInProcess(const RunOptions& options);

}  // namespace troupe
