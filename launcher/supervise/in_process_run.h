// `troupe run --in-process`: service and agents in this process, over memory instead of DDS. It runs the same code, so
// every state hash is the same.
#pragma once

#include <functional>
#include <memory>

#include "launcher/supervise/run_options.h"
#include "launcher/supervise/summary.h"
#include "transport/protocol/transport.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// Makes the viewer of a run; called once, unless the options say headless.
using MakeViewer = std::function<std::unique_ptr<RunObserver>(Transport& transport)>;

RunEnd RunInProcess(const RunOptions& options, const MakeViewer& make_viewer);

}  // namespace troupe
