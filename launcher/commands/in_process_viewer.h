// The viewer of a run in this process (`troupe run --in-process`): the gateway in threads of its own.
#pragma once

#include <memory>
#include <string>

#include "transport/protocol/transport.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// An observer that serves the page from the begin of the run to its end, and prints its address. Without a viewer, for
// want of a port, the run is the same. `session`: for the page. The transport outlives the run.
std::unique_ptr<RunObserver> MakeInProcessViewer(Transport& transport, const std::string& session);

}  // namespace troupe
