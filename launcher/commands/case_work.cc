#include "launcher/commands/case_work.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "common/base/file.h"
#include "launcher/commands/shown_expectations.h"
#include "launcher/commands/static_page.h"
#include "launcher/process/process.h"
#include "recording/recording.h"
#include "testing/cases/shrink.h"

namespace troupe {
namespace {

using nlohmann::json;

constexpr double kSecondsAfter = 2.0;  // simulated, of a recording after the tick that decides

// Runs `troupe` with these arguments to its end. The error has the last line that it printed.
// The case is recorded by `troupe run` itself, so that the recording is the same as one that a user makes of the
// scenario.
Status RunTroupe(const std::vector<std::string>& arguments, const ProgressFunction& progress) {
  Result<std::string> program = FindProgram("troupe");
  if (!program.ok()) return program.error();
  std::vector<std::string> command = {program.value()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  LinePipe output;
  Result<Process> process = Process::Start(command, output.writing_end());
  if (!process.ok()) return process.error();
  output.CloseWritingEnd();
  std::string last;
  while (!output.at_end()) {
    pollfd waited{output.reading_end(), POLLIN, 0};
    constexpr int kAliveMilliseconds = 1000;
    poll(&waited, 1, kAliveMilliseconds);
    progress(WorkProgress::kStep);  // of its ticks nothing is known here
    for (const std::string& line : output.Read()) last = line;
  }
  while (!process.value().Poll()) poll(nullptr, 0, 1);  // its pipe has ended
  if (process.value().end()->ok()) return {};
  return Failure(fmt::format("troupe {}: {}: {}", arguments.front(), process.value().end()->ToString(), last));
}

// A case as a scenario that stands alone, with the expectations of the test.
// Paths become absolute: the file is in another folder than the test. The expectations of the test are added for the
// page and for `troupe test`.
Status WriteScenario(const TestFile& test, const TestCase& draws, const std::string& path) {
  const Result<std::string> text = test.TextOf(draws);
  if (!text.ok()) return text.error();
  Result<ScenarioText> parsed = ScenarioText::Parse(text.value(), test.scenario_path());
  if (!parsed.ok()) return parsed.error();
  if (!test.expect().empty() && parsed.value().tree().root().Find("expect") == nullptr) {
    nlohmann::ordered_json expect = nlohmann::ordered_json::array();
    for (const TestClause& clause : test.expect()) expect.push_back({{"name", clause.name}, {"that", clause.text}});
    Result<std::string> with = parsed.value().With({DrawnValue{"expect", expect.dump()}});
    if (!with.ok()) return with.error();
    parsed = ScenarioText::Parse(std::move(with).value(), test.scenario_path());
    if (!parsed.ok()) return parsed.error();
  }
  return WriteWholeFile(path, parsed.value().WithAbsolutePaths(test.scenario_path()));
}

// The case in processes has the hashes of the case in this one.
Status CompareProcesses(const TestFile& test, const TestCase& draws, const std::vector<std::uint64_t>& hashes,
                        const std::filesystem::path& scratch, const ProgressFunction& progress) {
  // By process id: each worker has files of its own in the folder of the session.
  const std::string base = (scratch / std::to_string(getpid())).string();
  const std::string scenario = base + ".json";
  const std::string log = base + ".hashes";
  if (Status error = WriteScenario(test, draws, scenario); !error.ok()) return error;
  const std::string ticks = std::to_string(hashes.size() - 1);
  if (Status error = RunTroupe({"run", scenario, "--headless", "--no-ros", "--mode", "lockstep", "--speed", "max",
                                "--ticks", ticks, "--hash-log", log},
                               progress);
      !error.ok()) {
    return error;
  }
  const Result<std::string> text = ReadWholeFile(log, std::size_t{1} << 32);
  if (!text.ok()) return text.error();
  std::istringstream lines(text.value());
  std::size_t compared = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::uint64_t tick = 0;
    std::string hash;
    if (!(words >> tick >> hash) || tick >= hashes.size())
      return Failure("found the line '" + line + "' in a hash log");
    if (std::stoull(hash, nullptr, 16) != hashes[tick]) {
      return Failure(fmt::format("the run in processes differs from the run in one at tick {}", tick));
    }
    ++compared;
  }
  if (compared == hashes.size()) return {};
  return Failure(fmt::format("the run in processes has {} states, the run in one {}", compared, hashes.size()));
}

// The histories of expectations of a case that passed are large and not shown: they are not sent.
json Run(const CaseWorlds& worlds, const TestCase& draws, const JsonReader& request,
         const std::filesystem::path& scratch, const ProgressFunction& progress) {
  CaseRunOptions options;
  options.hashes = !scratch.empty();
  options.heat = request.Get<bool>("heat");
  options.progress = progress;
  CaseOutcome outcome = RunCase(worlds, draws, options);
  const std::vector<std::uint64_t> hashes = std::exchange(outcome.hashes, {});
  if (!scratch.empty() && outcome.verdict != CaseVerdict::kError) {
    if (const Status same = CompareProcesses(worlds.test(), draws, hashes, scratch, progress); !same.ok()) {
      outcome.verdict = CaseVerdict::kError;
      outcome.error = same.error().message;
    }
  }
  if (outcome.verdict == CaseVerdict::kPassed) {
    for (ExpectationOutcome& expectation : outcome.expectations) expectation.history.clear();
  }
  return ToJson(outcome);
}

json Shrink(const CaseWorlds& worlds, const TestCase& draws, const JsonReader& request,
            const ProgressFunction& progress) {
  const ShrunkCase shrunk = ShrinkCase(worlds, draws, request.Get<std::size_t>("expectation"), {}, progress);
  return {{"case", CaseToJson(shrunk.draws)},
          {"runs", shrunk.runs},
          {"robots", shrunk.robots},
          {"outcome", ToJson(shrunk.outcome)}};
}

Status WriteCasePage(const std::string& file, const StaticPageOptions& page) {
  const Result<Recording> recording = Recording::Open(file);
  if (!recording.ok()) return recording.error();
  return WriteStaticPage(recording.value(), ExpectationsOf(recording.value()), page);
}

// Each artifact is tried though another failed: a picture without a recording is of use.
json Keep(const CaseWorlds& worlds, const TestCase& draws, const JsonReader& request,
          const std::filesystem::path& folder, const ProgressFunction& progress) {
  const CaseOutcome outcome = ReadOutcome(request.Find("outcome").value());
  const auto failed = std::find_if(outcome.expectations.begin(), outcome.expectations.end(),
                                   [](const ExpectationOutcome& each) { return !each.holds; });
  const Tick tick = failed->cause_tick.value_or(outcome.ticks);
  const auto after = static_cast<Tick>(outcome.tick_seconds > 0.0 ? kSecondsAfter / outcome.tick_seconds : 0.0);
  const Tick last = std::min(outcome.ticks, std::max(tick, failed->decided_at.value_or(tick)) + after);
  json reply = {{"recording", ""}, {"page", ""}, {"picture", ""}, {"problem", ""}};
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  const std::string scenario = (folder / "scenario.json").string();
  Status status = failure ? Status(Failure(failure.message())) : WriteScenario(worlds.test(), draws, scenario);
  if (status.ok()) {
    status =
        RunTroupe({"run", scenario, "--in-process", "--headless", "--no-ros", "--mode", "lockstep", "--speed", "max",
                   "--ticks", std::to_string(std::max<Tick>(last, 1)), "--record", (folder / "run.mcap").string()},
                  progress);
    if (status.ok()) reply["recording"] = "run.mcap";
  }
  Status written;
  const StaticPageOptions page{{}, (folder / "run.html").string()};
  if (status.ok() && HasPageModule(page)) {
    written = WriteCasePage((folder / "run.mcap").string(), page);
    if (written.ok()) reply["page"] = "run.html";
  }
  CaseRunOptions options;
  options.picture = {tick, (folder / "violation.png").string()};
  options.progress = progress;
  const CaseOutcome shown = RunCase(worlds, draws, options);
  const Status saved = shown.verdict == CaseVerdict::kError ? Status(Failure(shown.error)) : Status();
  if (saved.ok()) reply["picture"] = "violation.png";
  for (const Status& each : {status, written, saved}) {
    if (!each.ok()) reply["problem"] = each.error().message;
  }
  return reply;
}

}  // namespace

// Any other kind is "run", as the requests are made by CaseSession alone.
json PerformCaseWork(const CaseWorlds& worlds, const JsonReader& request, const std::filesystem::path& folder,
                     const ProgressFunction& progress) {
  const auto kind = request.Get<std::string>("kind");
  const TestCase draws = ReadCase(request.Find("case").value());
  if (kind == "shrink") return Shrink(worlds, draws, request, progress);
  if (kind == "keep") return Keep(worlds, draws, request, folder, progress);
  return Run(worlds, draws, request, folder, progress);
}

}  // namespace troupe
