#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command_line/parse_command_line.h"
#include "command_line/terminal.h"
#include "common/base/distinct_files.h"
#include "launcher/commands/commands.h"
#include "launcher/export/run_export.h"
#include "recording/recording.h"
#include "world-service/replay/run_replay.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

struct ExportArguments {
  std::string file;
  std::string format;
  std::string output;
  std::optional<std::uint64_t> from;
  std::optional<std::uint64_t> to;
};

// The states that were written, for the line at the end.
struct ExportReport {
  std::uint64_t states = 0;
  Tick first = 0;
  Tick last = 0;
};

// Another format is one more RunExport (launcher/export/run_export.h).
Result<std::unique_ptr<RunExport>> MakeExport(const ExportArguments& arguments, const Recording& recording) {
  if (arguments.format == "league") return MakeLeagueExport(arguments.output, recording.run().file);
  if (arguments.format == "foxglove") return MakeFoxgloveExport(arguments.output);
  if (arguments.format == "ros2") return MakeRos2Export(arguments.output);
  return MakeCsvExport(arguments.output);
}

// Adds the states of the range to the export, as far as the recording is whole. The error is the damage, or that of a
// file.
Status AddStates(const Recording& recording, const ExportArguments& arguments, RunExport& target,
                 ExportReport& report) {
  const bool has_terminal = isatty(STDERR_FILENO) == 1;
  Clock::time_point shown_at = Clock::now();
  ReplayOptions options;
  options.from = arguments.from;
  // A range may end behind the recording.
  if (arguments.to && recording.spans().Last(*arguments.to)) options.to = arguments.to;
  options.on_state = [&](const ReplayedWorld& world, const RecordedTick& tick) {
    // Between two states of the range an edit may have led out of it.
    if (tick.tick < arguments.from.value_or(0) || tick.tick > arguments.to.value_or(tick.tick)) return Status();
    if (report.states++ == 0) report.first = tick.tick;
    report.last = tick.tick;
    return target.Add(world, tick.log_time);
  };
  options.on_progress = [&](Tick tick, double share) {
    if (!has_terminal || Clock::now() - shown_at <= std::chrono::milliseconds(500)) return;
    shown_at = Clock::now();
    fmt::print(stderr, "\r\033[Ktick {}, {:.0f} %", tick, 100.0 * share);
    std::fflush(stderr);
  };
  const Result<ReplayReport> replayed = RunReplay(recording, options).Run();
  if (!replayed.ok()) return replayed.error();
  const std::optional<std::string>& difference = replayed.value().difference;
  const std::optional<std::string>& end = difference ? difference : replayed.value().damage;
  return end ? Error{{recording.name()}, *end, ErrorCode::kFailure} : Status();
}

// The recording must not be overwritten by its own export.
Status CheckOutputs(const ExportArguments& arguments) {
  std::vector<std::string> files = {arguments.output};
  if (arguments.format == "ros2") files = FilesOfRos2Export(arguments.output);
  if (arguments.format == "csv") files = FilesOfCsvExport(arguments.output);
  std::vector<OutputName> outputs;
  for (const std::string& file : files) outputs.push_back({"-o", file});
  return CheckDistinct(outputs, [&] { return std::vector{arguments.file}; });
}

// Of a damaged recording the states before the damage are exported and counted, and the exit status is that of the
// damage.
int ExportCommand(const ExportArguments& arguments) {
  if (const Status problem = CheckOutputs(arguments); !problem.ok()) return Fail(problem.error());
  const Result<Recording> recording = OpenToReplay(arguments.file);
  if (!recording.ok()) return Fail(recording.error());
  Result<std::unique_ptr<RunExport>> target = MakeExport(arguments, recording.value());
  if (!target.ok()) return Fail(target.error());
  ExportReport report;
  const Status added = AddStates(recording.value(), arguments, *target.value(), report);
  ClearLine();
  const Status closed = target.value()->Close();
  if (!closed.ok()) return Fail(closed.error());
  if (report.states > 0) {
    fmt::print("{} states, of ticks {} to {}, in {}\n", report.states, report.first, report.last, arguments.output);
    std::fflush(stdout);
  }
  if (!added.ok()) return Fail(added.error());
  if (report.states == 0) return Fail({{arguments.file}, "found no state between the ticks of --from and --to"});
  return kExitDone;
}

}  // namespace

void AddExportCommand(CLI::App& app, int& exit_status) {
  CLI::App* command =
      app.add_subcommand("export", "Write a recording for other programs: Foxglove, ROS 2, tables, the League");
  const auto arguments = std::make_shared<ExportArguments>();  // lives as long as the command
  command->add_option("FILE", arguments->file, "A recording of 'troupe run --record FILE.mcap'")
      ->required()
      ->check(NotEmpty())
      ->type_name("");
  command
      ->add_option("--format", arguments->format,
                   "foxglove: an MCAP file for Foxglove, Lichtblick and Rerun; ros2: a bag for 'ros2 bag'; csv: tables "
                   "for pandas; league: the outcome of a problem of paths as JSON of the League of Robot Runners")
      ->required()
      ->check(OneOf({"foxglove", "ros2", "csv", "league"}))
      ->type_name("FORMAT");
  command
      ->add_option(
          "-o,--output", arguments->output,
          "The file to write; for ros2 a folder, or FILE.mcap; for csv a folder, or FILE.csv for the poses alone")
      ->required()
      ->check(NotEmpty())
      ->type_name("FILE");
  command->add_option("--from", arguments->from, "First tick (default: 0)")->check(WholeNumber(0))->type_name("TICK");
  command->add_option("--to", arguments->to, "Last tick (default: the last of the recording)")
      ->check(WholeNumber(0))
      ->type_name("TICK");
  command->final_callback([arguments, &exit_status] { exit_status = ExportCommand(*arguments); });
}

}  // namespace troupe
