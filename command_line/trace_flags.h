// The options --trace and --trace-ticks of the programs that work on ticks.
#pragma once

#include <string>
#include <vector>

#include "common/trace/tick_trace.h"

namespace CLI {
class App;
}

namespace troupe {

// `trace` must outlive the parsing.
void AddTraceFlags(CLI::App& app, TraceOptions& trace, const std::string& group = "Options");

// The arguments that give another program of Troupe the same options with `file` as its trace.
std::vector<std::string> TraceArguments(const TraceOptions& trace, const std::string& file);

}  // namespace troupe
