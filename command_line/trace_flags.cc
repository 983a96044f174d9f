#include "command_line/trace_flags.h"

#include <CLI/CLI.hpp>

#include "command_line/option_checks.h"

namespace troupe {

void AddTraceFlags(CLI::App& app, TraceOptions& trace, const std::string& group) {
  app.add_option("--trace", trace.file,
                 "Write the phases of all ticks as Chrome trace JSON, for ui.perfetto.dev or chrome://tracing")
      ->check(NotEmpty())
      ->type_name("FILE")
      ->group(group);
  const auto set = [&trace](const std::string& text) {
    const TraceOptions ticks = ParseTraceTicks(text).value();
    trace.first = ticks.first;
    trace.last = ticks.last;
  };
  app.add_option_function<std::string>("--trace-ticks", set,
                                       "Ticks that --trace covers; either end may be left out (default: all)")
      ->check(TraceTicksValue())
      ->type_name("FIRST:LAST")
      ->group(group);
}

std::vector<std::string> TraceArguments(const TraceOptions& trace, const std::string& file) {
  std::vector<std::string> arguments = {"--trace=" + file};
  if (trace.first > 0 || trace.last) {
    const std::string last = trace.last ? std::to_string(*trace.last) : "";
    arguments.push_back("--trace-ticks=" + std::to_string(trace.first) + ":" + last);
  }
  return arguments;
}

}  // namespace troupe
