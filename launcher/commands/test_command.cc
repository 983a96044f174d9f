// The commands `troupe test` and `troupe sweep`. docs/testing.md is their manual.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

#include "command_line/parse_command_line.h"
#include "common/base/distinct_files.h"
#include "common/base/file.h"
#include "common/base/print.h"
#include "launcher/commands/case_session.h"
#include "launcher/commands/commands.h"
#include "launcher/hosts/host.h"
#include "launcher/process/process.h"
#include "recording/recording.h"
#include "testing/expectations/tick_view.h"
#include "world-service/replay/run_replay.h"

namespace troupe {
namespace {

constexpr int kExitExpectationFailed = 1;
constexpr const char* kDefaultFolder = "troupe-test";  // of recordings and pictures without --report

// Of both commands; each declares the options that it has.
struct TestArguments {
  std::vector<std::string> files;
  std::size_t jobs = std::max(1U, std::thread::hardware_concurrency());
  std::string fixed;  // --case
  std::string shard;
  std::string junit;
  std::string report;  // folder
  std::uint64_t search = 0;
  bool no_shrink = false;
  bool processes = false;
  std::optional<double> case_timeout;  // s
  std::string recording;               // --on

  std::vector<std::string> merged;  // folders, of sweep
};

std::string CheckShard(const std::string& text) {
  return ParseShard(text) ? "" : "found '" + text + "', expected I/N with I from 1 to N, for instance 2/4";
}

// Of the report, and of recordings and pictures.
std::string FolderOf(const TestArguments& arguments) {
  return arguments.report.empty() ? kDefaultFolder : arguments.report;
}

Result<CaseSessionOptions> SessionOptions(const TestArguments& arguments) {
  CaseSessionOptions options;
  options.jobs = arguments.jobs;
  if (!arguments.shard.empty()) options.shard = *ParseShard(arguments.shard);
  Result<TestCase> fixed = ParseCase(arguments.fixed);
  if (!fixed.ok()) return fixed.error();
  options.fixed = std::move(fixed).value();
  options.search = arguments.search;
  options.shrink = !arguments.no_shrink;
  options.processes = arguments.processes;
  options.case_timeout = arguments.case_timeout;
  options.heat = !arguments.report.empty();
  // A case that is repeated leaves no files that were not asked for.
  if (!arguments.report.empty() || arguments.fixed.empty()) options.folder = FolderOf(arguments);
  return options;
}

// The file of --junit, and those of a report, as far as they are there: the others overwrite nothing.
std::vector<OutputName> OutputsOf(const TestArguments& arguments) {
  std::vector<OutputName> outputs = {{"--junit", arguments.junit}};
  if (arguments.report.empty()) return outputs;
  const std::filesystem::path folder = arguments.report;
  for (const char* name : {"index.html", "cases.jsonl"}) outputs.push_back({"the report", (folder / name).string()});
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failure)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".csv" || ending == ".svg" || ending == ".png")
      outputs.push_back({"the report", entry.path().string()});
  }
  return outputs;
}

// Before the run: hours of cases must not end in a file that cannot be written, or overwrite a file that they read.
Status CheckOutputs(const TestArguments& arguments, const std::function<std::vector<std::string>()>& inputs) {
  if (Status problem = CheckDistinct(OutputsOf(arguments), inputs); !problem.ok()) return problem;
  if (!arguments.junit.empty()) {
    if (const Status status = CheckWritable(arguments.junit); !status.ok()) {
      return Error{{arguments.junit}, "cannot write: " + status.error().message};
    }
  }
  if (arguments.report.empty()) return {};
  std::error_code failure;
  std::filesystem::create_directories(arguments.report, failure);
  if (failure) return Error{{arguments.report}, "cannot make the folder: " + failure.message()};
  return {};
}

// The JUnit file first: a build server needs it even if the folder of the report cannot be written.
Status WriteReports(const CaseReport& report, const TestArguments& arguments) {
  if (!arguments.junit.empty()) {
    if (Status error = WriteWholeFile(arguments.junit, report.JUnit(FolderOf(arguments))); !error.ok()) return error;
  }
  if (arguments.report.empty()) return {};
  if (Status error = report.Write(arguments.report); !error.ok()) return error;
  PrintPlain(stdout, "report: {}\n", (std::filesystem::path(arguments.report) / "index.html").string());
  return {};
}

// Those of the recording, as they were; those that only the test knows, from its scenario as it is now, if that loads.
std::vector<NamedRegion> RegionsFor(const TestFile& test, const RecordedRun& run) {
  std::vector<NamedRegion> regions = run.regions;
  const Result<LoadedWorld> loaded = CaseWorlds(test).Load(test.design().At(0));
  if (!loaded.ok()) return regions;
  for (const NamedRegion& each : loaded.value().regions) {
    const auto same = [&](const NamedRegion& other) { return other.name == each.name; };
    if (std::none_of(regions.begin(), regions.end(), same)) regions.push_back(each);
  }
  return regions;
}

// Adds a test, and its outcome on a recording, to the report.
// The expectations see each recorded state once, as they would in a run. An edit changes the world under them, which no
// expectation could interpret.
Result<CaseOutcome> TestRecording(const TestFile& test, const std::string& path, CaseReport& report, bool with_heat) {
  const Result<Recording> recording = OpenToReplay(path);
  if (!recording.ok()) return recording.error();
  const RecordedRun& run = recording.value().run();
  Result<CaseMonitors> monitors = CaseMonitors::Make(test, run.world, RegionsFor(test, run));
  if (!monitors.ok()) return monitors.error();
  const Status unedited =
      recording.value().VisitEdits(recording.value().chunks(), [&](std::uint64_t, const RecordedEdit& edit) -> Status {
        return Error{
            {path},
            fmt::format("found an edit of the world at tick {}, expected a run without edits", edit.before.state.tick)};
      });
  if (!unedited.ok()) return unedited.error();
  std::vector<HeatMap> heat;
  if (with_heat) heat = test.heat().EmptyMaps();
  ReplayOptions options;
  options.on_state = [&](const ReplayedWorld& world, const RecordedTick& tick) {
    const bool is_first = tick.number == 0;
    if (!is_first) {
      for (HeatMap& map : heat) map.Add(world.world(), world.state());
    }
    const TickView view{*world.scene(), world.bodies(), world.state(),
                        is_first ? std::span<const Event>() : tick.events};
    return monitors.value().Push(view);
  };
  const Result<ReplayReport> replayed = RunReplay(recording.value(), options).Run();
  if (!replayed.ok()) return replayed.error();
  const ReplayReport& end = replayed.value();
  const std::optional<std::string>& fault = end.difference ? end.difference : end.damage;
  if (fault) return Error{{path}, *fault, ErrorCode::kFailure};
  CaseOutcome outcome;
  outcome.ticks = end.last;
  outcome.state_hash = end.state_hash;
  outcome.tick_seconds = recording.value().run().world.interval_seconds();
  monitors.value().Finish(outcome);
  ReportedTest reported = ReportOf(test, monitors.value());
  reported.vary.clear();
  reported.cases = 1;
  if (with_heat) reported.heat = test.heat();
  report.AddTest(reported, run.world);
  report.AddHeat(report.size() - 1, heat);
  return outcome;
}

void PrintOutcome(const TestFile& test, const CaseOutcome& outcome) {
  for (std::size_t i = 0; i < test.expect().size(); ++i) {
    const ExpectationOutcome& each = outcome.expectations[i];
    const std::string tick = each.cause_tick ? fmt::format(", decided by tick {}", *each.cause_tick) : "";
    const std::string names = each.causes.empty() ? "" : fmt::format(" and {}", fmt::join(each.causes, ", "));
    PrintPlain(stdout, "{} {}: robustness {:.4g}{}{}\n", each.holds ? "holds" : "FAILS", test.expect()[i].name,
               each.robustness, tick, names);
  }
  for (std::size_t i = 0; i < test.metrics().size(); ++i) {
    const std::optional<double>& metric = outcome.metrics[i];
    PrintPlain(stdout, "{}: {}\n", test.metrics()[i].name, metric ? fmt::format("{:.6g}", *metric) : "none");
  }
}

// All tests are read before the first replay, which may take long.
int TestOnRecording(const TestArguments& arguments) {
  const Result<std::vector<std::string>> files = FindTests(arguments.files);
  if (!files.ok()) return Fail(files.error());
  std::vector<TestFile> tests;
  for (const std::string& path : files.value()) {
    Result<TestFile> test = TestFile::Read(path);
    if (!test.ok()) return Fail(test.error());
    tests.push_back(std::move(test).value());
  }
  const Status outputs = CheckOutputs(arguments, [&] {
    std::vector<std::string> inputs = {arguments.recording};
    for (const TestFile& test : tests) inputs.insert(inputs.end(), {test.path(), test.scenario_path()});
    return inputs;
  });
  if (!outputs.ok()) return Fail(outputs.error());
  CaseReport report;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    Result<CaseOutcome> outcome = TestRecording(tests[i], arguments.recording, report, !arguments.report.empty());
    if (!outcome.ok()) return Fail(outcome.error());
    PrintOutcome(tests[i], outcome.value());
    ReportedCase reported{0, false, {}, std::move(outcome).value()};
    if (reported.outcome.verdict != CaseVerdict::kPassed) {
      reported.command =
          fmt::format("troupe test {} --on {}", ShellQuoted(tests[i].path()), ShellQuoted(arguments.recording));
    }
    report.AddCase(i, std::move(reported));
  }
  for (const std::string& name : report.Uncovered()) PrintPlain(stdout, "not covered: {}\n", name);
  if (const Status status = WriteReports(report, arguments); !status.ok()) return Fail(status.error());
  return report.Count(CaseVerdict::kFailed) > 0 ? kExitExpectationFailed : kExitDone;
}

// With the verdicts of tests, or as a sweep, in which only a case that cannot be run is a failure.
enum class Purpose : bool { kTest, kSweep };

// In a sweep a violated expectation is a result.
int RunCases(const TestArguments& arguments, Purpose purpose) {
  Result<CaseSessionOptions> options = SessionOptions(arguments);
  if (!options.ok()) return Fail(options.error());
  options.value().keep_failing = purpose == Purpose::kTest;
  if (arguments.junit.empty() && arguments.report.empty()) options.value().detail = CaseDetail::kCounts;
  CaseSession session(std::move(options).value());
  if (const Status status = session.Load(arguments.files); !status.ok()) return ExitStatusOf(status.error());
  const Status outputs = CheckOutputs(arguments, [&] { return session.InputFiles(); });
  if (!outputs.ok()) return Fail(outputs.error());
  // Until all files are written: a second Ctrl-C, or the second signal of `timeout`, costs no report.
  SignalWatch signals;
  const Result<bool> whole = session.Run(signals);
  if (!whole.ok()) return Fail(whole.error());
  for (const std::string& name : session.report().Uncovered()) PrintPlain(stdout, "not covered: {}\n", name);
  if (const Status status = WriteReports(session.report(), arguments); !status.ok()) return Fail(status.error());
  for (const std::string& line : session.Summary()) PrintPlain(stdout, "{}\n", line);
  std::fflush(stdout);
  signals.ReadStopRequest();  // one that has come meanwhile must not end this process without its exit status
  if (!whole.value()) return kExitInterrupted;
  const auto any = [&](CaseVerdict verdict) {
    return session.report().Count(verdict) + session.report().CountKept(verdict) > 0;
  };
  if (purpose == Purpose::kTest && any(CaseVerdict::kFailed)) return kExitExpectationFailed;
  return any(CaseVerdict::kError) ? kExitFailed : kExitDone;
}

// Reports of shards: each has the same tests, and other cases.
int Merge(const TestArguments& arguments) {
  CaseReport report;
  std::vector<std::string> inputs;
  for (const std::string& folder : arguments.merged) {
    inputs.push_back((std::filesystem::path(folder) / "cases.jsonl").string());
  }
  const Status outputs = CheckOutputs(arguments, [&] { return inputs; });
  if (!outputs.ok()) return Fail(outputs.error());
  for (const std::string& folder : arguments.merged) {
    if (const Status status = report.Merge(folder, arguments.report); !status.ok()) return Fail(status.error());
  }
  if (const Status status = report.FinishMerge(); !status.ok()) return Fail(status.error());
  if (const Status status = WriteReports(report, arguments); !status.ok()) return Fail(status.error());
  return kExitDone;
}

int SweepCommand(const TestArguments& arguments) {
  if (!arguments.merged.empty()) return Merge(arguments);
  if (!arguments.files.empty()) return RunCases(arguments, Purpose::kSweep);
  return Fail({{}, "found no FILE, expected a test, or --merge with folders of sweeps"});
}

void AddCommonOptions(CLI::App& command, TestArguments& arguments) {
  command.add_option("--jobs", arguments.jobs, "Cases that run at once (default: one for each core)")
      ->check(WholeNumber(1, 1000))
      ->type_name("N");
  command
      .add_option("--shard", arguments.shard,
                  "Run only each N-th case, beginning with case I: N machines, each with another I, run all")
      ->check(CLI::Validator(CheckShard, ""))
      ->type_name("I/N");
  command
      .add_option("--case-timeout", arguments.case_timeout,
                  "End a case that takes longer, as an error (default: one that takes 60 s for a tick)")
      ->check(PositiveNumber())
      ->type_name("SECONDS");
  command.add_option("--junit", arguments.junit, "Write the verdicts as JUnit XML")
      ->check(NotEmpty())
      ->type_name("FILE")
      ->group("Reports");
}

}  // namespace

void AddTestCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("test", "Run the cases of tests: scenarios with expectations");
  const auto arguments = std::make_shared<TestArguments>();  // lives as long as the command
  command->add_option("FILE", arguments->files, "Tests, and folders with *.test.json files")
      ->required()
      ->check(NotEmpty())
      ->type_name("");
  AddCommonOptions(*command, *arguments);
  command->add_option("--case", arguments->fixed, "Run the cases with these draws only")->type_name("NAME=VALUE,...");
  command
      ->add_option("--search", arguments->search,
                   "Run up to N cases in search of one that fails, near those that nearly fail")
      ->check(WholeNumber(1, kMaxCases))
      ->type_name("N");
  command->add_flag("--no-shrink", arguments->no_shrink, "Do not look for the smallest case that fails");
  command->add_flag("--processes", arguments->processes,
                    "Run each case by a world service and robot processes, too, and require the same hashes");
  command->add_option("--on", arguments->recording, "Test a recorded run instead of the cases")
      ->check(NotEmpty())
      ->type_name("RECORDING.mcap");
  command
      ->add_option("--report", arguments->report,
                   "Write a page, a table, plots, and the recordings of cases that fail into a folder")
      ->check(NotEmpty())
      ->type_name("DIR")
      ->group("Reports");
  command->final_callback([arguments, &exit_status] {
    exit_status = arguments->recording.empty() ? RunCases(*arguments, Purpose::kTest) : TestOnRecording(*arguments);
  });
}

void AddSweepCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("sweep", "Run the cases of tests for their metrics: tables and plots");
  const auto arguments = std::make_shared<TestArguments>();  // lives as long as the command
  command->add_option("FILE", arguments->files, "Tests, and folders with *.test.json files")
      ->check(NotEmpty())
      ->type_name("");
  command->add_option("-o,--output", arguments->report, "The folder of the report")
      ->required()
      ->check(NotEmpty())
      ->type_name("DIR");
  AddCommonOptions(*command, *arguments);
  command->add_option("--merge", arguments->merged, "Join the reports of the shards of one sweep")
      ->check(NotEmpty())
      ->type_name("DIR ...");
  command->final_callback([arguments, &exit_status] { exit_status = SweepCommand(*arguments); });
}

}  // namespace troupe
