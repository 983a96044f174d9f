// The options --trace and --trace-ticks of the programs that make ticks.
#pragma once

#include <CLI/CLI.hpp>

#include "common/trace/tick_trace.h"

namespace troupe {

// Declares them. `trace` must outlive the parsing.
void AddTraceFlags(CLI::App& app, TraceOptions& trace);

}  // namespace troupe
