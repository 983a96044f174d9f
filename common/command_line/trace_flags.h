// The options --trace and --trace-ticks of the programs that make ticks.
#pragma once

#include "common/trace/tick_trace.h"

namespace CLI {
class App;
}

namespace troupe {

// Declares them. `trace` must outlive the parsing.
void AddTraceFlags(CLI::App& app, TraceOptions& trace);

}  // namespace troupe
