#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "command_line/exit_status.h"
#include "command_line/option_checks.h"
#include "command_line/run_flags.h"
#include "common/base/file.h"
#include "common/base/utf8.h"
#include "launcher/commands/commands.h"
#include "launcher/commands/controller_check.h"
#include "world-service/replay/run_replay.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

struct ReplayArguments {
  std::string file;
  bool verify = false;
  bool controllers = false;
  bool force = false;
  std::optional<std::uint64_t> from;
  std::optional<std::uint64_t> to;
  OutputFiles outputs;
  std::string scans;
};

// A status line on a terminal, for replays that take longer than a moment.
class ReplayProgress {
 public:
  ~ReplayProgress() {
    if (shown_) fmt::print(stderr, "\r\033[K");
  }
  void Update(Tick tick, double share) {
    if (!terminal_ || Clock::now() < next_) return;
    next_ = Clock::now() + std::chrono::milliseconds(500);
    shown_ = true;
    fmt::print(stderr, "\r\033[Ktick {}, {:.0f} %", tick, 100.0 * share);
    std::fflush(stderr);
  }

 private:
  const bool terminal_ = isatty(STDERR_FILENO) == 1;
  bool shown_ = false;
  Clock::time_point next_ = Clock::now() + std::chrono::milliseconds(500);
};

Status CheckOutputs(const ReplayArguments& arguments) {
  for (const std::string* output : {&arguments.outputs.hash_log, &arguments.outputs.poses, &arguments.scans}) {
    std::error_code failure;
    if (output->empty()) continue;
    if (std::filesystem::equivalent(*output, arguments.file, failure)) {
      return Error{{*output}, "found the recording itself, expected another file to write"};
    }
    if (const Status status = CheckWritable(*output); !status.ok()) {
      return Error{{*output}, "cannot write: " + status.error().message};
    }
  }
  return {};
}

// "601 states, of ticks 0 to 600"
std::string StatesText(const ReplayReport& report) {
  if (report.states == 0) return "no state";
  return fmt::format("{} states, of ticks {} to {},", report.states, report.first, report.last);
}

std::string ControllersText(const ControllerCheck& check) {
  std::string text = fmt::format("{} proposals of controllers are equal\n", check.compared());
  if (!check.lost().empty()) {
    text += fmt::format("not compared since their agents were lost: {}\n",
                        PlainLine(fmt::format("{}", fmt::join(check.lost(), ", "))));
  }
  return text;
}

int ReplayCommand(const ReplayArguments& arguments) {
  if (const Status problem = CheckOutputs(arguments); !problem.ok()) return Fail(problem.error());
  const Result<Recording> recording = Recording::Open(arguments.file);
  if (!recording.ok()) return Fail(recording.error());
  if (const Status other = CheckStepVersion(recording.value()); !other.ok() && !arguments.force) {
    Error error = other.error();
    error.message += "; --force replays it, and names the first difference";
    return Fail(error);
  }
  ReplayOptions options;
  options.from = arguments.from;
  options.to = arguments.to;
  options.compare_events = arguments.verify;
  options.outputs = arguments.outputs;
  options.scans = arguments.scans;
  std::optional<ControllerCheck> controllers;
  if (arguments.controllers) {
    Result<ControllerCheck> check = ControllerCheck::Create(recording.value());
    if (!check.ok()) return Fail(check.error());
    controllers.emplace(std::move(check).value());
    options.check = [&](const ReplayedWorld& world, const RecordedTick& next) {
      return controllers->Check(world, next);
    };
  }
  auto progress = std::make_unique<ReplayProgress>();
  options.on_progress = [&progress](Tick tick, double share) { progress->Update(tick, share); };
  const Clock::time_point begin = Clock::now();
  const Result<ReplayReport> replayed = RunReplay(recording.value(), options).Run();
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  progress.reset();
  if (!replayed.ok()) return Fail(replayed.error());

  const ReplayReport& report = replayed.value();
  const char* outcome = report.difference ? " before the first difference"
                        : report.damage   ? " before the damage: their state hashes are equal"
                                          : ": all state hashes are equal";
  fmt::print("{} replayed in {:.2f} s{}\n", StatesText(report), seconds, outcome);
  if (report.states > 0) fmt::print("state hash of tick {}: {:016x}\n", report.last, report.state_hash);
  std::fflush(stdout);
  if (report.difference) return Fail({{arguments.file}, *report.difference, ErrorCode::kFailure});
  if (report.damage) return Fail({{arguments.file}, *report.damage, ErrorCode::kFailure});
  if (!arguments.verify) return kExitDone;
  if (const Status damaged = recording.value().CheckData(); !damaged.ok()) return Fail(damaged.error());
  fmt::print("all recorded events are equal, and the file is whole\n");
  if (controllers) fmt::print("{}", ControllersText(*controllers));
  return kExitDone;
}

}  // namespace

void AddReplayCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("replay", "Step a recorded run again, and compare every state with it");
  const auto arguments = std::make_shared<ReplayArguments>();  // lives as long as the command
  command->add_option("FILE", arguments->file, "A recording of 'troupe run --record FILE.mcap'")
      ->required()
      ->check(NotEmpty())
      ->type_name("");
  CLI::Option* const verify =
      command->add_flag("--verify", arguments->verify, "Compare the events, too, and check the CRC of the whole file");
  command
      ->add_flag("--controllers", arguments->controllers,
                 "Run the controllers again, too, from the begin of the run, and compare their proposals: names the "
                 "first robot, tick and number that differs")
      ->needs(verify);
  command->add_flag("--force", arguments->force, "Replay a recording of another version of the step, too");
  command->add_option("--from", arguments->from, "First tick; stepping starts at the keyframe before (default: 0)")
      ->check(WholeNumber(0))
      ->type_name("TICK");
  command->add_option("--to", arguments->to, "Last tick (default: the last of the recording)")
      ->check(WholeNumber(0))
      ->type_name("TICK");
  const char* group = "Output files, as those of the run";
  AddHashLogFlag(*command, arguments->outputs.hash_log, group);
  AddPosesFlag(*command, arguments->outputs.poses, group);
  AddScansFlag(*command, arguments->scans, group);
  command->final_callback([arguments, &exit_status] { exit_status = ReplayCommand(*arguments); });
}

}  // namespace troupe
