#include "launcher/commands/case_session.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/json.h"
#include "common/base/print.h"
#include "launcher/commands/case_work.h"
#include "launcher/commands/temporary_folder.h"
#include "launcher/hosts/host.h"
#include "launcher/process/process.h"
#include "testing/cases/worker_pool.h"
#include "world-service/service/requested_file.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

using nlohmann::json;
using std::chrono::steady_clock;

constexpr std::size_t kMaxExamined = 10;  // faults of a test that are shrunk and recorded
constexpr std::size_t kMaxPrinted = 20;   // faults of a test that are printed
constexpr double kTickTimeout = 60.0;     // s: a controller that takes longer does not return

double SecondsSince(steady_clock::time_point time) {
  return std::chrono::duration<double>(steady_clock::now() - time).count();
}

std::string NameOfCase(const TestCase& draws) {
  return draws.empty() ? "the only case" : CaseText(draws);
}

// Between this process and a worker, which is a copy of it: its members are there.
JsonReader ReadMessage(const std::string& text) {
  return JsonReader::OfText(text, "", JsonLimits::OfProcesses());
}

}  // namespace

// All tests are read before an error ends the session, so that a user sees the faults of all files at once.
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
  file_names_ = FileNamesOf(files.value());
  return first;
}

// The world of the first case is loaded here: a test whose world or expectations are wrong fails before any case runs.
Status CaseSession::LoadTest(const std::string& path) {
  Result<TestFile> read = TestFile::Read(path, options_.fixed);
  if (!read.ok()) return read.error();
  LoadedTest test;
  test.file = std::make_unique<TestFile>(std::move(read).value());
  test.worlds = std::make_unique<CaseWorlds>(*test.file);
  const CaseDesign& design = test.file->design();
  const TestCase first = design.At(0);
  if (Status error = test.worlds->Check(first); !error.ok()) return error;

  const LoadedWorld loaded = test.worlds->Load(first).value();  // Check has loaded it
  ReportedTest reported = ReportOf(*test.file, CaseMonitors::Make(*test.file, loaded.world, loaded.regions).value());
  reported.cases = options_.search > 0 ? 0 : design.size();
  reported.shard = options_.shard;
  if (options_.heat) reported.heat = test.file->heat();
  report_.AddTest(reported, loaded.world);
  if (options_.search > 0) {
    if (const Status rare = design.CheckRandom(); !rare.ok()) return Error{{path}, rare.error().message};
    test.search.emplace(test.file->design());
    planned_ += options_.search;
  } else {
    const std::uint64_t size = design.size();
    const Shard& shard = options_.shard;
    // Numbers from 0, shards from 1: case n is of shard n modulo count, plus 1.
    planned_ += size / shard.count + (size % shard.count >= shard.index ? 1 : 0);
  }
  if (options_.keep_failing && options_.fixed.empty()) ReadKept(test);
  if (design.impossible_pairs() > 0) {
    PrintPlain(stderr, "{}: warning: {} pairs of values meet no case that meets the constraints\n", path,
               design.impossible_pairs());
  }
  tests_.push_back(std::move(test));
  return {};
}

std::vector<std::string> CaseSession::InputFiles() const {
  // Cases that are looked at. Only texts can name files, and few of the many cases of a design differ in these.
  constexpr std::uint64_t kMaxLookedAt = 10'000;
  std::vector<std::string> files;
  for (const LoadedTest& test : tests_) {
    files.insert(files.end(), {test.file->path(), test.file->scenario_path(), KeptCasesPath(*test.file)});
    std::set<std::vector<std::string>> seen;
    const CaseDesign& design = test.file->design();
    const std::vector<Variation>& variations = design.variations();
    const bool are_numbers = std::all_of(variations.begin(), variations.end(),
                                         [](const Variation& each) { return each.NumberBounds().has_value(); });
    const std::uint64_t count = are_numbers ? 1 : std::min(design.size(), kMaxLookedAt);
    for (std::uint64_t number = 0; number < count; ++number) {
      const TestCase draws = design.At(number);
      std::vector<std::string> texts;
      for (const DrawnValue& draw : draws) {
        if (draw.value.starts_with('"')) texts.push_back(draw.value);
      }
      if (!seen.insert(std::move(texts)).second) continue;
      const Result<LoadedWorld> loaded = test.worlds->Load(draws);
      if (!loaded.ok()) continue;
      const std::vector<std::string> named = InputFilesOf(loaded.value());
      files.insert(files.end(), named.begin(), named.end());
    }
  }
  return files;
}

// A kept case of the design is run once, in the shard that has it; the first shard runs those beside the design.
void CaseSession::ReadKept(LoadedTest& test) {
  std::vector<std::string> warnings;
  Result<std::vector<KeptCase>> kept = ReadKeptCases(*test.file, warnings);
  if (!kept.ok()) warnings.push_back("warning: " + kept.error().ToString());
  for (const std::string& warning : warnings) PrintPlain(stderr, "{}\n", warning);
  if (!kept.ok()) return;
  const Shard& shard = options_.shard;
  std::uint64_t beside = std::max(test.file->design().size(), options_.search);
  for (KeptCase& each : kept.value()) {
    Job job{tests_.size(), beside, true, std::move(each.draws), {}};
    if (each.number && options_.search == 0) {
      if (!shard.Has(*each.number)) continue;
      job.number = *each.number;
      job.kept = false;
      test.begun.insert(*each.number);
    } else {
      if (shard.index != 1) continue;
      ++beside;
      ++planned_;
    }
    test.first.push_back(std::move(job));
  }
  test.first_open = test.first.size();
}

// Tests in their order. A later test may begin while the search of an earlier one waits, so that no worker is idle.
std::optional<CaseSession::Job> CaseSession::NextJob() {
  for (std::size_t i = current_; i < tests_.size(); ++i) {
    if (std::optional<Job> job = NextJobOf(i)) {
      job->began = steady_clock::now();
      return job;
    }
    const LoadedTest& test = tests_[i];
    // The next case of a search may follow from an outcome that is missing.
    const bool waits = test.search && !test.search->ends && test.next < options_.search;
    if (i == current_ && !waits) ++current_;
  }
  return std::nullopt;
}

// Cases that failed before come first: a fault that is still there shows within seconds.
std::optional<CaseSession::Job> CaseSession::NextJobOf(std::size_t number) {
  LoadedTest& test = tests_[number];
  if (!test.first.empty()) {
    Job job = std::move(test.first.front());
    test.first.pop_front();
    return job;
  }
  if (test.search) {
    if (test.first_open > 0 || test.search->ends || test.next >= options_.search) return std::nullopt;
    std::optional<CaseSearch::Proposal> proposal = test.search->cases.Next();
    if (!proposal) return std::nullopt;
    ++test.next;
    return Job{number, proposal->number, false, std::move(proposal->draws), {}};
  }
  const Shard& shard = options_.shard;
  const CaseDesign& design = test.file->design();
  for (;;) {
    const std::uint64_t next = test.next++ * shard.count + shard.index - 1;
    if (next >= design.size()) return std::nullopt;
    if (!test.begun.contains(next)) return Job{number, next, false, design.At(next), {}};
  }
}

// Quoted for a shell: the line is to be copied.
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
  const double seconds = SecondsSince(job.began);
  if (test.search) {
    FinishSearched(test, {job, std::move(outcome), seconds});
  } else {
    Report(job, std::move(outcome), seconds);
  }
  ShowProgress(false);
}

// The cases up to the first that does not pass, whatever else has been run beside it.
void CaseSession::FinishSearched(LoadedTest& test, Found found) {
  Search& search = *test.search;
  const bool passed = found.outcome.verdict == CaseVerdict::kPassed;
  const std::uint64_t number = found.job.number;
  if (found.job.kept) {
    Report(found.job, found.outcome, found.seconds);
    search.known_cases.emplace(number, std::move(found));
    search.ends = search.ends || !passed;
    if (--test.first_open > 0) return;
    if (search.ends) planned_ -= options_.search;
    for (const auto& [_, known] : search.known_cases) {
      if (known.job.draws.size() == test.file->design().variations().size())
        search.cases.AddKnown(known.job.draws, known.outcome);
    }
    search.known_cases.clear();
    return;
  }
  search.cases.Add(number, found.outcome);
  search.ends = search.ends || !passed;
  search.waiting.emplace(number, std::move(found));
  while (search.waiting.contains(search.reported)) {
    auto next = search.waiting.extract(search.reported);
    const bool ends = next.mapped().outcome.verdict != CaseVerdict::kPassed;
    Report(next.mapped().job, std::move(next.mapped().outcome), next.mapped().seconds);
    if (ends) planned_ -= options_.search - search.reported - 1;
    // Cases of greater numbers are none of the search: with fewer jobs they would not have begun.
    search.reported = ends ? options_.search : search.reported + 1;
  }
}

// The lists are ordered by place and cut at their ends, so that they are the same whatever the order of outcomes.
void CaseSession::Report(const Job& job, CaseOutcome outcome, double seconds) {
  LoadedTest& test = tests_[job.test];
  ++done_;
  const Place place{!job.kept, job.number};
  const auto keep_first = [&](auto& list, auto value, std::size_t most) {
    list.emplace(place, std::move(value));
    if (list.size() > most) list.erase(std::prev(list.end()));
  };
  // Of a case that could not be run to its end nothing is counted, as of its metrics.
  const std::vector<HeatMap> heat = std::exchange(outcome.heat, {});
  if (outcome.verdict != CaseVerdict::kError) report_.AddHeat(job.test, heat);
  ReportedCase reported{job.number, job.kept, job.draws, std::move(outcome)};
  if (reported.outcome.verdict == CaseVerdict::kFailed) {
    ++test.failing_count;
    keep_first(test.failing, job.draws, kMaxKeptCases);
  }
  if (reported.outcome.verdict != CaseVerdict::kPassed) {
    reported.command = CommandOf(test, job.draws);
    ++test.fault_count;
    keep_first(test.faults, reported, kMaxPrinted);
  }
  report_.AddCase(job.test, std::move(reported), seconds);
}

void CaseSession::KeepFailing(const LoadedTest& test) const {
  if (!options_.keep_failing || !options_.fixed.empty() || test.failing.empty()) return;
  std::vector<TestCase> failing;
  for (const auto& [place, draws] : test.failing) failing.push_back(draws);
  const Result<std::size_t> left_out = KeepCases(*test.file, failing);
  if (!left_out.ok()) {
    PrintPlain(stderr, "warning: {}\n", left_out.error().ToString());
  } else if (const std::uint64_t count = left_out.value() + test.failing_count - failing.size(); count > 0) {
    PrintPlain(stderr, "{}: warning: {} failing cases are not kept: its file of kept cases has no more than {}\n",
               test.file->path(), count, kMaxKeptCases);
  }
}

std::string CaseSession::FolderOf(std::size_t test, std::uint64_t number) const {
  return fmt::format("{}-{}", file_names_[test], number);
}

Result<bool> CaseSession::Run(SignalWatch& signals) {
  began_ = steady_clock::now();
  const auto stop = [&signals] {
    signals.ReadStopRequest();
    return signals.stop_requested();
  };
  std::optional<TemporaryFolder> scratch;  // of this process: a worker that is terminated removes nothing
  if (options_.processes) {
    scratch.emplace();
    if (scratch->path().empty()) return Failure("cannot make a folder for temporary files");
  }
  WorkerPool pool(options_.jobs, [this, &scratch](const std::string& text, const ProgressFunction& progress) {
    const JsonReader request = ReadMessage(text);
    const auto test = request.Get<std::size_t>("test");
    // Names of folders need not be UTF-8, so that no request has one.
    std::filesystem::path folder = scratch ? scratch->path() : "";
    if (request.Get<std::string>("kind") == "keep") {
      folder = std::filesystem::path(options_.folder) / FolderOf(test, request.Get<std::uint64_t>("number"));
    }
    return JsonText(PerformCaseWork(*tests_[test].worlds, request, folder, progress));
  });
  std::map<std::string, Job> jobs;  // by request
  // Requests are texts: the pool passes them to another process.
  const auto next = [&]() -> std::optional<std::string> {
    std::optional<Job> job = NextJob();
    if (!job) return std::nullopt;
    std::string request = json{{"kind", "run"},
                               {"test", job->test},
                               {"number", job->number},
                               {"case", CaseToJson(job->draws)},
                               {"heat", options_.heat && !job->kept}}
                              .dump();
    jobs.emplace(request, std::move(*job));
    return request;
  };
  // A worker that died or exceeded a limit has no reply: the case is an error, and the session goes on.
  const auto done = [&](const std::string& request, const Result<std::string>& reply) {
    const auto job = jobs.find(request);
    CaseOutcome outcome;
    outcome.verdict = CaseVerdict::kError;
    if (reply.ok()) {
      outcome = ReadOutcome(ReadMessage(reply.value()));
    } else {
      outcome.error = reply.error().message;
    }
    Finish(job->second, std::move(outcome));
    jobs.erase(job);
  };
  const Result<bool> ran = pool.Run(next, done, Limits(), signals.descriptor(), stop);
  ShowProgress(true);
  if (!ran.ok()) return ran.error();
  // Of a run without an end this is all that there is to see.
  for (const auto& [request, job] : jobs) {
    const TestFile& test = *tests_[job.test].file;
    PrintPlain(stdout, "NOT RUN {}: {}\n  stopped after {:.1f} s\n  repeat: {}\n", test.name(), NameOfCase(job.draws),
               SecondsSince(job.began), CommandOf(tests_[job.test], job.draws));
  }
  if (!ran.value() && options_.search == 0) {
    // The cases without an outcome are in the report as not run.
    const auto leave = [&](const Job& job) { report_.AddCase(job.test, {job.number, job.kept, job.draws}); };
    for (const auto& [request, job] : jobs) leave(job);
    while (const std::optional<Job> job = NextJob()) leave(*job);
  }
  for (std::size_t i = 0; i < tests_.size(); ++i) {
    for (auto& [place, fault] : tests_[i].faults) faults_.emplace_back(i, std::move(fault));
  }
  Result<bool> examined = options_.keep_failing ? Examine(pool, ran.value(), stop, signals.descriptor()) : ran;
  for (const auto& [test, fault] : faults_) Print(fault, report_.test(test));
  for (const LoadedTest& test : tests_) {
    if (test.fault_count > kMaxPrinted)
      PrintPlain(stdout, "{}: {} more that did not pass\n", test.file->path(), test.fault_count - kMaxPrinted);
    KeepFailing(test);
  }
  return examined;
}

// Without --case-timeout the limit is one of each tick: a long case may be in order, a tick of a minute is not.
WorkLimits CaseSession::Limits() const {
  WorkLimits limits;
  limits.part = options_.case_timeout;
  if (!options_.case_timeout) limits.step = kTickTimeout;
  return limits;
}

// Only cases that failed are shrunk: an error has no expectation that a smaller case could violate.
Result<bool> CaseSession::Examine(WorkerPool& pool, bool going_on, const std::function<bool()>& stop,
                                  int stop_descriptor) {
  FaultWork work{pool, stop, stop_descriptor, {}, {}};
  std::map<std::size_t, std::size_t> of_test;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const auto& [test, fault] = faults_[i];
    if (fault.outcome.verdict != CaseVerdict::kFailed || of_test[test]++ >= kMaxExamined) continue;
    work.chosen.push_back(i);
    work.smallest[i] = {fault.draws, fault.outcome};
  }
  Result<bool> examined = going_on;
  if (going_on && options_.shrink && options_.fixed.empty()) examined = Shrink(work);
  if (!examined.ok() || !examined.value() || options_.folder.empty()) return examined;
  return Keep(work);
}

Result<bool> CaseSession::ForEachChosen(FaultWork& work, const WorkLimits& limits,
                                        const std::function<json(std::size_t)>& request_for,
                                        const std::function<std::string(std::size_t, const JsonReader&)>& use) {
  std::size_t place = 0;
  const auto next = [&]() -> std::optional<std::string> {
    if (place >= work.chosen.size()) return std::nullopt;
    const std::size_t i = work.chosen[place++];
    json request = request_for(i);
    request["fault"] = i;
    request["test"] = faults_[i].first;
    return JsonText(request);
  };
  const auto done = [&](const std::string& request, const Result<std::string>& reply) {
    const auto i = ReadMessage(request).Get<std::size_t>("fault");
    const std::string problem = reply.ok() ? use(i, ReadMessage(reply.value())) : reply.error().message;
    if (!problem.empty()) PrintPlain(stderr, "warning: the case {}: {}\n", CaseText(faults_[i].second.draws), problem);
  };
  return work.pool.Run(next, done, limits, work.stop_descriptor, work.stop);
}

Result<bool> CaseSession::Shrink(FaultWork& work) {
  const auto request_for = [&](std::size_t i) {
    const ReportedCase& fault = faults_[i].second;
    const auto& list = fault.outcome.expectations;
    const auto failed = std::find_if(list.begin(), list.end(), [](const auto& each) { return !each.holds; });
    return json{{"kind", "shrink"}, {"case", CaseToJson(fault.draws)}, {"expectation", failed - list.begin()}};
  };
  const auto use = [&](std::size_t i, const JsonReader& answer) -> std::string {
    auto& [test, fault] = faults_[i];
    const TestCase draws = ReadCase(answer.Find("case").value());
    CaseOutcome outcome = ReadOutcome(answer.Find("outcome").value());
    if (outcome.verdict != CaseVerdict::kFailed) return "cannot shrink it: " + outcome.error;
    if (draws == fault.draws) return "";
    fault.shrunk = fmt::format("{} ({}, {}, after {})", CommandOf(tests_[test], draws),
                               CountText(answer.Get<std::size_t>("robots"), "robot"), CountText(outcome.ticks, "tick"),
                               CountText(answer.Get<std::size_t>("runs"), "run"));
    work.smallest[i] = {draws, std::move(outcome)};
    return "";
  };
  return ForEachChosen(work, Limits(), request_for, use);
}

Result<bool> CaseSession::Keep(FaultWork& work) {
  const auto request_for = [&](std::size_t i) {
    auto& [test, fault] = faults_[i];
    const auto& [draws, outcome] = work.smallest[i];
    fault.folder = FolderOf(test, fault.number);
    return json{{"kind", "keep"}, {"number", fault.number}, {"case", CaseToJson(draws)}, {"outcome", ToJson(outcome)}};
  };
  const auto use = [&](std::size_t i, const JsonReader& answer) -> std::string {
    auto& [test, fault] = faults_[i];
    fault.recording = answer.Get<std::string>("recording");
    fault.picture = answer.Get<std::string>("picture");
    fault.page = answer.Get<std::string>("page");
    report_.UpdateFault(test, fault);
    const auto problem = answer.Get<std::string>("problem");
    return problem.empty() ? "" : "cannot keep it: " + problem;
  };
  // Without limits: the case has ended before, and its recording and page take their time without a word.
  return ForEachChosen(work, {}, request_for, use);
}

void CaseSession::Print(const ReportedCase& fault, const ReportedTest& test) const {
  PrintPlain(stdout, "{} {}: {}\n", fault.outcome.verdict == CaseVerdict::kFailed ? "FAILED" : "ERROR", test.name,
             NameOfCase(fault.draws));
  for (const std::string& line : FaultLines(test, fault, options_.folder)) PrintPlain(stdout, "  {}\n", line);
}

// Kept cases are counted apart, so that the numbers of the design are comparable from session to session.
std::vector<std::string> CaseSession::Summary() const {
  const double seconds = SecondsSince(began_);
  const auto counts = [](const auto& count) {
    return fmt::format("{} passed, {} failed, {} errors", count(CaseVerdict::kPassed), count(CaseVerdict::kFailed),
                       count(CaseVerdict::kError));
  };
  std::vector<std::string> lines;
  if (report_.HasKept())
    lines.push_back("kept cases: " + counts([&](CaseVerdict verdict) { return report_.CountKept(verdict); }));
  lines.push_back(fmt::format("{}, {} not run in {:.1f} s",
                              counts([&](CaseVerdict verdict) { return report_.Count(verdict); }), not_run(), seconds));
  return lines;
}

}  // namespace troupe
