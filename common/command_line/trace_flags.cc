#include "common/command_line/trace_flags.h"

#include <CLI/CLI.hpp>

#include "common/command_line/option_checks.h"

namespace troupe {

void AddTraceFlags(CLI::App& app, TraceOptions& trace) {
  app.add_option("--trace", trace.file, "write what was done when, for chrome://tracing or ui.perfetto.dev")
      ->type_name("FILE");
  const auto take = [&trace](const std::string& text) {
    const TraceOptions ticks = ParseTraceTicks(text).value();
    trace.first = ticks.first;
    trace.last = ticks.last;
  };
  app.add_option_function<std::string>("--trace-ticks", take, "which ticks --trace is for; default: all")
      ->check(TraceTicksValue())
      ->type_name("FIRST:LAST");
}

}  // namespace troupe
