// The two ways of `troupe run`: a process for each agent, or all in this process. Their hashes are the same.
//
// Both end in a RunEnd, from which ReportEnd prints the summary and the exit status follows; so what a user sees of a
// run does not depend on the way. ReportEnd comes before a viewer that stays open is stopped: the result is there at
// once.
#pragma once

#include <functional>
#include <memory>

#include "common/spatial/scene_cache.h"
#include "launcher/process/process.h"
#include "launcher/supervise/reports.h"
#include "launcher/supervise/run_options.h"
#include "transport/protocol/transport.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// `troupe run` over DDS: a world service and its agents, a process each.
// Starts, supervises and terminates all processes; none is left when it returns. Returns the exit status.
int RunDistributed(const RunOptions& options, const ReportEnd& report);

// `troupe run --in-process`: service and agents in this process, over memory instead of DDS. It runs the same code, so
// every state hash is the same.

// Makes the viewer of a run; called once, unless the options say headless.
using MakeViewer =
    std::function<std::unique_ptr<RunObserver>(Transport& transport, std::shared_ptr<SceneCache> scenes)>;

int RunInProcess(const RunOptions& options, const MakeViewer& make_viewer, const ReportEnd& report);

// Whether the viewer of a run that has ended in this way stays open until the user ends it.
bool StaysOpen(const RunOptions& options, const RunEnd& end);
inline constexpr const char* kPageStaysOpen = "the run has ended; its page stays open until Ctrl-C";
// Tells the user, and waits for a request to stop.
void AwaitStopOfViewer(SignalWatch& signals, Progress& progress);

}  // namespace troupe
