// `troupe run --in-process`: service and agents in this process, over memory instead of DDS. The same code decides, so
// every state hash is the same.
#pragma once

#include "launcher/run_end.h"
#include "launcher/run_options.h"

namespace troupe {

RunEnd RunInProcess(const RunOptions& options);

}  // namespace troupe
