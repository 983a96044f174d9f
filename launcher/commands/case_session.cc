#include "launcher/commands/case_session.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

#include "common/base/file.h"
#include "common/base/print.h"
#include "launcher/hosts/host.h"
#include "launcher/process/process.h"
#include "testing/cases/worker_pool.h"

namespace troupe {
namespace {

using nlohmann::json;
using std::chrono::steady_clock;

constexpr std::size_t kMostExamined = 10;  // faults of a test that are shrunk and recorded
constexpr std::size_t kMostPrinted = 20;   // faults of a test that are printed
constexpr std::size_t kMostKept = 100;     // cases in a file of failing ones
constexpr std::size_t kMostFailingBytes = 10'000'000;
constexpr double kSecondsAfter = 2.0;  // simulated, of a recording after the tick that decides

std::string FailingPath(const std::string& path) {
  return std::filesystem::path(path).replace_extension(".failing").string();
}

// Runs `troupe` with these arguments to its end. The error has the last line that it printed.
Status RunTroupe(const std::vector<std::string>& arguments) {
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
    poll(&waited, 1, -1);
    for (const std::string& line : output.Read()) last = line;
  }
  while (!process.value().Poll()) poll(nullptr, 0, 1);  // its pipe has ended
  if (process.value().end()->ok()) return {};
  return Failure(fmt::format("troupe {}: {}: {}", arguments.front(), process.value().end()->ToString(), last));
}

// A folder for temporary files, which is removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "troupe-case-XXXXXX").string();
    if (mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }  // empty: it could not be made

 private:
  std::string path_;
};

// A case as a scenario that stands alone.
Status WriteScenario(const TestFile& test, const TestCase& draws, const std::string& path) {
  const Result<std::string> text = test.TextOf(draws);
  if (!text.ok()) return text.error();
  const Result<ScenarioText> parsed = ScenarioText::Parse(text.value(), test.scenario_path());
  if (!parsed.ok()) return parsed.error();
  const std::string folder = std::filesystem::absolute(test.scenario_path()).parent_path().string();
  return WriteWholeFile(path, parsed.value().WithAbsolutePaths(folder));
}

// The case in processes has the hashes of the case in this one.
Status CompareProcesses(const TestFile& test, const TestCase& draws, const std::vector<std::uint64_t>& hashes) {
  const TemporaryFolder folder;
  if (folder.path().empty()) return Failure("cannot make a folder for temporary files");
  const std::string scenario = folder.path() + "/scenario.json";
  const std::string log = folder.path() + "/hashes";
  if (Status error = WriteScenario(test, draws, scenario); !error.ok()) return error;
  const std::string ticks = std::to_string(hashes.size() - 1);
  if (Status error = RunTroupe({"run", scenario, "--headless", "--no-ros", "--mode", "lockstep", "--speed", "max",
                                "--ticks", ticks, "--hash-log", log});
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

}  // namespace

std::optional<Shard> ParseShard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  if (index.ec != std::errc() || index.ptr == end || *index.ptr != '/') return std::nullopt;
  const auto count = std::from_chars(index.ptr + 1, end, shard.count);
  if (count.ec != std::errc() || count.ptr != end || shard.index < 1 || shard.index > shard.count) return std::nullopt;
  return shard;
}

Status CaseSession::Load(const std::vector<std::string>& paths) {
  Result<std::vector<std::string>> files = FindTests(paths);
  if (!files.ok()) {
    PrintPlain(stderr, "{}\n", files.error().ToString());
    return files.error();
  }
  Status first;
  for (const std::string& path : files.value()) {
    const Status status = LoadTest(path);
    if (status.ok()) continue;
    PrintPlain(stderr, "{}\n", status.error().ToString());
    if (first.ok()) first = status;
  }
  return first;
}

Status CaseSession::LoadTest(const std::string& path) {
  Result<TestFile> read = TestFile::Read(path, options_.fixed);
  if (!read.ok()) return read.error();
  LoadedTest test;
  test.file = std::make_unique<TestFile>(std::move(read).value());
  test.worlds = std::make_unique<CaseWorlds>(*test.file);
  const CaseDesign& design = test.file->design();
  const TestCase first = design.At(0);
  if (Status error = test.worlds->Check(first); !error.ok()) return error;

  ReportedTest reported{path, test.file->name(), {}, {}, {}, {}, {}, {}, design.size()};
  for (const Variation& variation : design.variations()) reported.vary.push_back(variation.path());
  const LoadedWorld loaded = test.worlds->Load(first).value();  // Check has loaded it
  const CaseMonitors monitors = CaseMonitors::Make(*test.file, loaded.world, loaded.regions).value();
  for (std::size_t i = 0; i < test.file->expect().size(); ++i) {
    reported.expect.push_back(test.file->expect()[i].name);
    reported.formulas.push_back(monitors.expectations()[i].expectation().formula());
  }
  for (const TestClause& clause : test.file->cover()) reported.cover.push_back(clause.name);
  for (std::size_t i = 0; i < test.file->metrics().size(); ++i) {
    reported.metrics.push_back(test.file->metrics()[i].name);
    reported.units.push_back(monitors.metrics()[i].metric().unit());
  }
  report_.AddTest(reported);
  if (options_.keep_failing && options_.fixed.empty()) ReadKept(test);
  if (options_.search > 0) {
    test.search = std::make_unique<CaseSearch>(test.file->design());
    planned_ += options_.search + test.kept.size();
  } else {
    const std::uint64_t size = design.size();
    const Shard& shard = options_.shard;
    planned_ += test.kept.size() + size / shard.count + (size % shard.count >= shard.index ? 1 : 0);
  }
  if (design.impossible_pairs() > 0) {
    PrintPlain(stderr, "{}: warning: {} pairs of values meet no case that meets the constraints\n", path,
               design.impossible_pairs());
  }
  tests_.push_back(std::move(test));
  return {};
}

void CaseSession::ReadKept(LoadedTest& test) const {
  if (options_.shard.index != 1) return;  // the first shard runs them
  const std::string path = FailingPath(test.file->path());
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return;
  const Result<std::string> text = ReadWholeFile(path, kMostFailingBytes);
  if (!text.ok()) {
    PrintPlain(stderr, "{}: warning: cannot read: {}\n", path, text.error().message);
    return;
  }
  std::istringstream lines(text.value());
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.empty() || line.front() == '#') continue;
    const Result<TestCase> draws = ParseCase(line);
    if (draws.ok() && test.file->CanMake(draws.value())) {
      test.kept.push_back(draws.value());
    } else {
      PrintPlain(stderr, "{}:{}:1: warning: found {}, no case of the test any more; it is not run\n", path, number,
                 line);
    }
  }
}

void CaseSession::WriteKept(const LoadedTest& test) const {
  if (test.new_failing.empty() || options_.shard.count > 1) return;
  const std::string path = FailingPath(test.file->path());
  std::string text = "# Cases that have failed. 'troupe test' runs them first; remove a line to forget its case.\n";
  std::vector<std::string> lines;
  for (const TestCase& kept : test.kept) lines.push_back(CaseText(kept));
  for (const std::string& line : test.new_failing) {
    if (std::find(lines.begin(), lines.end(), line) == lines.end() && lines.size() < kMostKept) lines.push_back(line);
  }
  for (const std::string& line : lines) text += line + "\n";
  if (const Status status = WriteWholeFile(path, text); !status.ok()) {
    PrintPlain(stderr, "{}: warning: cannot write: {}\n", path, status.error().message);
  }
}

std::optional<CaseSession::Job> CaseSession::NextJob() {
  for (; current_ < tests_.size(); ++current_) {
    LoadedTest& test = tests_[current_];
    const CaseDesign& design = test.file->design();
    const std::uint64_t index = test.next++;
    if (index < test.kept.size()) {
      return Job{current_, std::max(design.size(), options_.search) + index, test.kept[index], steady_clock::now()};
    }
    const std::uint64_t place = index - test.kept.size();
    if (test.search) {
      if (place < options_.search && test.faults == 0)
        return Job{current_, place, test.search->Next(), steady_clock::now()};
      if (test.faults > 0) planned_ -= options_.search - std::min(place, options_.search);  // found: the search ends
    } else {
      const std::uint64_t number = place * options_.shard.count + options_.shard.index - 1;
      if (number < design.size()) return Job{current_, number, design.At(number), steady_clock::now()};
    }
  }
  return std::nullopt;
}

std::string CaseSession::Answer(const std::string& text) const {
  const json request = json::parse(text);
  const std::string kind = request.at("kind");
  if (kind == "shrink") return AnswerShrink(request).dump();
  if (kind == "keep") return AnswerKeep(request).dump();
  const LoadedTest& test = tests_[request.at("test")];
  const TestCase draws = CaseFromJson(request.at("case"));
  CaseRunOptions options;
  std::vector<std::uint64_t> hashes;
  if (options_.processes) {
    options.on_tick = [&](const Simulation& simulation) {
      hashes.push_back(simulation.state_hash());
      return true;
    };
  }
  CaseOutcome outcome = RunCase(*test.worlds, draws, options);
  if (options_.processes && outcome.verdict != CaseVerdict::kError) {
    if (const Status same = CompareProcesses(*test.file, draws, hashes); !same.ok()) {
      outcome.verdict = CaseVerdict::kError;
      outcome.error = same.error().message;
    }
  }
  if (outcome.verdict == CaseVerdict::kPassed) {
    for (ExpectationOutcome& expectation : outcome.expectations) expectation.history.clear();
  }
  return ToJson(outcome).dump();
}

json CaseSession::AnswerShrink(const json& request) const {
  const LoadedTest& test = tests_[request.at("test")];
  const ShrunkCase shrunk = ShrinkCase(*test.worlds, CaseFromJson(request.at("case")), request.at("expectation"));
  return {{"case", CaseToJson(shrunk.draws)},
          {"ticks", shrunk.outcome.ticks},
          {"runs", shrunk.runs},
          {"robots", shrunk.robots},
          {"outcome", ToJson(shrunk.outcome)}};
}

// Writes the case as a scenario, its recording, and a picture of the tick that decides.
json CaseSession::AnswerKeep(const json& request) const {
  const LoadedTest& test = tests_[request.at("test")];
  const TestCase draws = CaseFromJson(request.at("case"));
  const std::filesystem::path folder(request.at("folder").get<std::string>());
  const Tick tick = request.at("tick");
  const Tick last = request.at("last");
  json reply = {{"recording", ""}, {"picture", ""}, {"problem", ""}};
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  const std::string scenario = (folder / "scenario.json").string();
  Status status = failure ? Status(Failure(failure.message())) : WriteScenario(*test.file, draws, scenario);
  if (status.ok()) {
    status =
        RunTroupe({"run", scenario, "--in-process", "--headless", "--no-ros", "--mode", "lockstep", "--speed", "max",
                   "--ticks", std::to_string(std::max<Tick>(last, 1)), "--record", (folder / "run.mcap").string()});
    if (status.ok()) reply["recording"] = "run.mcap";
  }
  Status saved;
  CaseRunOptions options;
  options.on_tick = [&](const Simulation& simulation) {
    if (simulation.tick() < tick) return true;
    saved = simulation.SavePicture((folder / "violation.png").string());
    return false;
  };
  RunCase(*test.worlds, draws, options);
  if (saved.ok()) reply["picture"] = "violation.png";
  for (const Status& each : {status, saved}) {
    if (!each.ok()) reply["problem"] = each.error().message;
  }
  return reply;
}

std::string CaseSession::CommandOf(const LoadedTest& test, const TestCase& draws) const {
  std::string command = "troupe test " + ShellQuoted(test.file->path());
  if (!draws.empty()) command += " --case " + ShellQuoted(CaseText(draws));
  return command;
}

void CaseSession::ShowProgress(bool end) {
  if (isatty(STDERR_FILENO) == 0) return;
  const auto now = steady_clock::now();
  if (end) {
    if (progress_shown_) fmt::print(stderr, "\r\x1b[K");
    progress_shown_ = false;
    return;
  }
  if (now - shown_ < std::chrono::milliseconds(200)) return;
  shown_ = now;
  progress_shown_ = true;
  const double passed = std::chrono::duration<double>(now - began_).count();
  const double left = done_ > 0 ? passed / static_cast<double>(done_) * static_cast<double>(not_run()) : 0.0;
  fmt::print(stderr, "\r\x1b[K{} of {} cases, {} failed, {} errors, {:.0f} s left", done_, planned_,
             report_.Count(CaseVerdict::kFailed), report_.Count(CaseVerdict::kError), std::ceil(left));
  std::fflush(stderr);
}

void CaseSession::Finish(const Job& job, CaseOutcome outcome) {
  LoadedTest& test = tests_[job.test];
  ++done_;
  const double seconds = std::chrono::duration<double>(steady_clock::now() - job.began).count();
  if (test.search) test.search->Add(job.draws, outcome);
  ReportedCase reported{job.number, job.draws, std::move(outcome), ""};
  if (reported.outcome.verdict != CaseVerdict::kPassed) {
    reported.command = CommandOf(test, job.draws);
    if (++test.faults <= kMostPrinted) faults_.emplace_back(job.test, reported);
  }
  report_.AddCase(job.test, std::move(reported), seconds);
  ShowProgress(false);
}

Result<bool> CaseSession::Run() {
  began_ = steady_clock::now();
  SignalWatch signals;
  const auto stop = [&signals] {
    signals.ReadStopRequest();
    return signals.stop_requested();
  };
  WorkerPool pool(options_.jobs, [this](const std::string& request) { return Answer(request); });
  std::map<std::string, Job> jobs;  // by request
  const auto next = [&]() -> std::optional<std::string> {
    std::optional<Job> job = NextJob();
    if (!job) return std::nullopt;
    std::string request =
        json{{"kind", "run"}, {"test", job->test}, {"number", job->number}, {"case", CaseToJson(job->draws)}}.dump();
    jobs.emplace(request, std::move(*job));
    return request;
  };
  const auto done = [&](const std::string& request, const Result<std::string>& reply) {
    const auto job = jobs.find(request);
    CaseOutcome outcome;
    outcome.verdict = CaseVerdict::kError;
    if (reply.ok()) {
      outcome = OutcomeFromJson(json::parse(reply.value()));
    } else {
      outcome.error = reply.error().message;
    }
    Finish(job->second, std::move(outcome));
    jobs.erase(job);
  };
  const Result<bool> ran = pool.Run(next, done, signals.descriptor(), stop);
  ShowProgress(true);
  if (!ran.ok()) return ran.error();
  // In the order of their numbers, those that were kept first, whatever the order of their ends.
  std::sort(faults_.begin(), faults_.end(), [this](const auto& a, const auto& b) {
    const auto place = [this](const auto& fault) {
      const bool kept = fault.second.number >= tests_[fault.first].file->design().size() && options_.search == 0;
      return std::tuple(fault.first, !kept, fault.second.number);
    };
    return place(a) < place(b);
  });
  Result<bool> examined = ran.value() && options_.keep_failing ? Examine(pool, stop, signals.descriptor()) : ran;
  for (const auto& [test, fault] : faults_) Print(fault, tests_[test]);
  for (const LoadedTest& test : tests_) {
    if (test.faults > kMostPrinted)
      PrintPlain(stdout, "{}: {} more that did not pass\n", test.file->path(), test.faults - kMostPrinted);
    if (options_.keep_failing && options_.fixed.empty()) WriteKept(test);
  }
  return examined;
}

Result<bool> CaseSession::Examine(WorkerPool& pool, const std::function<bool()>& stop, int stop_descriptor) {
  std::vector<std::size_t> chosen;  // faults that failed, the first of each test
  std::map<std::size_t, std::size_t> of_test;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const bool failed = faults_[i].second.outcome.verdict == CaseVerdict::kFailed;
    if (failed && of_test[faults_[i].first]++ < kMostExamined) chosen.push_back(i);
  }
  // The cases to be recorded: shrunk ones, where there are any.
  std::map<std::size_t, std::pair<TestCase, CaseOutcome>> smallest;
  for (const std::size_t i : chosen) smallest[i] = {faults_[i].second.draws, faults_[i].second.outcome};
  std::size_t place = 0;
  if (options_.shrink && options_.fixed.empty()) {
    const auto next = [&]() -> std::optional<std::string> {
      if (place >= chosen.size()) return std::nullopt;
      const auto& [test, fault] = faults_[chosen[place]];
      const auto& list = fault.outcome.expectations;
      const auto failed = std::find_if(list.begin(), list.end(), [](const auto& each) { return !each.holds; });
      return json{{"kind", "shrink"},
                  {"fault", chosen[place++]},
                  {"test", test},
                  {"case", CaseToJson(fault.draws)},
                  {"expectation", failed - list.begin()}}
          .dump();
    };
    const auto done = [&](const std::string& request, const Result<std::string>& reply) {
      const std::size_t i = json::parse(request).at("fault");
      if (!reply.ok()) return;
      const json answer = json::parse(reply.value());
      const TestCase draws = CaseFromJson(answer.at("case"));
      CaseOutcome outcome = OutcomeFromJson(answer.at("outcome"));
      if (outcome.verdict != CaseVerdict::kFailed || draws == faults_[i].second.draws) return;
      faults_[i].second.shrunk =
          fmt::format("{} ({}, {}, after {})", CommandOf(tests_[faults_[i].first], draws),
                      CountText(answer.at("robots").get<std::size_t>(), "robot"), CountText(outcome.ticks, "tick"),
                      CountText(answer.at("runs").get<std::size_t>(), "run"));
      smallest[i] = {draws, std::move(outcome)};
    };
    Result<bool> shrunk = pool.Run(next, done, stop_descriptor, stop);
    if (!shrunk.ok() || !shrunk.value()) return shrunk;
  }
  if (options_.fixed.empty()) {
    for (const auto& [i, small] : smallest) tests_[faults_[i].first].new_failing.push_back(CaseText(small.first));
  }
  if (options_.folder.empty()) return true;

  place = 0;
  const auto next = [&]() -> std::optional<std::string> {
    if (place >= chosen.size()) return std::nullopt;
    const std::size_t i = chosen[place++];
    auto& [test, fault] = faults_[i];
    const auto& [draws, outcome] = smallest[i];
    const auto& list = outcome.expectations;
    const auto failed = std::find_if(list.begin(), list.end(), [](const auto& each) { return !each.holds; });
    const Tick tick = failed->cause_tick.value_or(outcome.ticks);
    const auto after = static_cast<Tick>(outcome.tick_seconds > 0.0 ? kSecondsAfter / outcome.tick_seconds : 0.0);
    const Tick last = std::min(outcome.ticks, std::max(tick, failed->decided_at.value_or(tick)) + after);
    fault.folder =
        fmt::format("{}-{}", std::filesystem::path(tests_[test].file->path()).stem().stem().string(), fault.number);
    return json{{"kind", "keep"},
                {"fault", i},
                {"test", test},
                {"case", CaseToJson(draws)},
                {"tick", tick},
                {"last", last},
                {"folder", (std::filesystem::path(options_.folder) / fault.folder).string()}}
        .dump();
  };
  const auto done = [&](const std::string& request, const Result<std::string>& reply) {
    auto& [test, fault] = faults_[json::parse(request).at("fault")];
    const json answer = reply.ok() ? json::parse(reply.value()) : json{{"problem", reply.error().message}};
    fault.recording = answer.value("recording", "");
    fault.picture = answer.value("picture", "");
    const std::string problem = answer.value("problem", "");
    if (!problem.empty()) PrintPlain(stderr, "warning: cannot keep the case {}: {}\n", CaseText(fault.draws), problem);
    report_.AddCase(test, fault, report_.SecondsOf(test, fault.number));
  };
  return pool.Run(next, done, stop_descriptor, stop);
}

void CaseSession::Print(const ReportedCase& fault, const LoadedTest& test) const {
  const CaseOutcome& outcome = fault.outcome;
  const std::string text = CaseText(fault.draws);
  PrintPlain(stdout, "{} {}: {}\n", outcome.verdict == CaseVerdict::kFailed ? "FAILED" : "ERROR", test.file->name(),
             text.empty() ? "the only case" : text);
  if (!outcome.error.empty()) PrintPlain(stdout, "  {}\n", outcome.error);
  for (std::size_t i = 0; i < outcome.expectations.size(); ++i) {
    const ExpectationOutcome& each = outcome.expectations[i];
    if (each.holds) continue;
    const std::string tick = each.cause_tick ? fmt::format(" at tick {}", *each.cause_tick) : "";
    const std::string names = each.causes.empty() ? "" : fmt::format(" of {}", fmt::join(each.causes, ", "));
    PrintPlain(stdout, "  {}: fails{}{}, robustness {:.4g}\n", test.file->expect()[i].name, tick, names,
               each.robustness);
  }
  PrintPlain(stdout, "  repeat: {}\n", fault.command);
  if (!fault.shrunk.empty()) PrintPlain(stdout, "  smallest: {}\n", fault.shrunk);
  const std::filesystem::path folder = std::filesystem::path(options_.folder) / fault.folder;
  if (!fault.recording.empty()) PrintPlain(stdout, "  recording: {}\n", (folder / fault.recording).string());
  if (!fault.picture.empty()) PrintPlain(stdout, "  picture: {}\n", (folder / fault.picture).string());
}

std::string CaseSession::Summary() const {
  const double seconds = std::chrono::duration<double>(steady_clock::now() - began_).count();
  return fmt::format("{} passed, {} failed, {} errors, {} not run in {:.1f} s", report_.Count(CaseVerdict::kPassed),
                     report_.Count(CaseVerdict::kFailed), report_.Count(CaseVerdict::kError), not_run(), seconds);
}

}  // namespace troupe
