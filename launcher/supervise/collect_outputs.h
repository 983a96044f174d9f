// The output files of a run over DDS, at its end: copied from remote hosts, and merged from the parts of its processes.
//
// The processes have ended, so that their files are complete. Copies may be large: progress is shown, and a stop
// request ends them without losing what is on this host already.
#pragma once

#include "launcher/process/process.h"
#include "launcher/supervise/agent_fleet.h"
#include "launcher/supervise/reports.h"
#include "launcher/supervise/run_options.h"
#include "launcher/supervise/service_process.h"
#include "troupe/result.h"

namespace troupe {

// Continues after a failure, and returns the first: the scans of a run that failed may show the cause. A request to
// stop ends the copies.
Status CollectOutputs(const RunOptions& options, const RunHosts& hosts, ServiceProcess& service, AgentFleet& agents,
                      SignalWatch& signals, Progress& progress);

}  // namespace troupe
