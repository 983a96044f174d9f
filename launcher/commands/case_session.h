// CaseSession: runs the cases of tests in several processes, shrinks those that fail, and keeps their recordings and
// pictures. `troupe test` and `troupe sweep` use it.
//
// This process plans and reports; workers (testing/cases/worker_pool.h) run cases, so that a case that crashes or does
// not end costs one case and not the session. Outcomes arrive in any order; faults are printed in that of cases. A
// case depends on its test and its draws only, never on the worker, the number of jobs or earlier cases: that is why a
// failing case can be repeated by one command, and shards need no coordination.
//
// Order of work: cases that failed in earlier sessions, then the design or the search, then shrinking of the first
// faults.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "testing/cases/case_run.h"
#include "testing/cases/kept_cases.h"
#include "testing/cases/shrink.h"
#include "testing/cases/test_file.h"
#include "testing/reports/case_report.h"
#include "troupe/result.h"

namespace troupe {

// A part of all cases: those whose numbers are `index` - 1 modulo `count`.
struct Shard {
  std::uint64_t index = 1;
  std::uint64_t count = 1;
};
// "2/4"; nothing for any other text.
std::optional<Shard> ParseShard(const std::string& text);

class SignalWatch;

struct CaseSessionOptions {
  std::size_t jobs = 1;
  Shard shard;
  TestCase fixed;            // --case; empty: all cases
  std::uint64_t search = 0;  // cases of a search in place of the design; 0: none
  bool shrink = true;
  bool keep_failing = true;  // reads and writes the files of failing cases, runs those first, and makes artifacts
  bool processes = false;    // each case is run by processes, too, and has to have the same hashes
  std::optional<double> case_timeout;      // s, of wall time, of a case; nothing: none but that of each tick
  std::string folder;                      // of recordings and pictures; empty: none are made
  CaseDetail detail = CaseDetail::kCases;  // of the report
};

class CaseSession {
 public:
  explicit CaseSession(CaseSessionOptions options) : options_(std::move(options)), report_(options_.detail) {}

  // Reads and checks the tests. The error is the first one; all are printed.
  Status Load(const std::vector<std::string>& paths);
  // The files that the tests read, of worlds those of the first case.
  std::vector<std::string> InputFiles() const;
  // Runs the cases, and prints those that do not pass. False: it was interrupted by one of the signals; the cases until
  // then are reported.
  Result<bool> Run(SignalWatch& signals);

  const CaseReport& report() const { return report_; }
  // "198 passed, 2 failed, 0 errors, 0 not run in 3.2 s", behind a line of the kept cases, if any.
  std::vector<std::string> Summary() const;
  std::uint64_t not_run() const { return planned_ > done_ ? planned_ - done_ : 0; }

 private:
  struct Job {
    std::size_t test = 0;
    std::uint64_t number = 0;
    bool kept = false;  // beside the design
    TestCase draws;
    std::chrono::steady_clock::time_point began;
  };
  struct LoadedTest {
    std::unique_ptr<TestFile> file;
    std::unique_ptr<CaseWorlds> worlds;
    KeptCases kept;                 // that failed in earlier sessions
    std::deque<Job> first;          // of them, those that have not begun
    std::set<std::uint64_t> begun;  // of the design, the kept ones
    std::uint64_t next = 0;         // of the other cases of the design's shard, or of the search
    std::unique_ptr<CaseSearch> search;
    std::vector<TestCase> new_failing;  // for the file
    std::size_t faults = 0;
  };

  Status LoadTest(const std::string& path);
  void ReadKept(LoadedTest& test);
  std::optional<Job> NextJob();
  void Finish(const Job& job, CaseOutcome outcome);
  // The smallest cases, recordings and pictures of the first faults, unless it was interrupted (`going_on` is false);
  // the cases are kept all the same. False: interrupted.
  Result<bool> Examine(WorkerPool& pool, bool going_on, const std::function<bool()>& stop, int stop_descriptor);
  struct FaultWork {
    WorkerPool& pool;
    const std::function<bool()>& stop;
    int stop_descriptor;
    std::vector<std::size_t> chosen;  // faults that failed, the first of each test
    // By fault; the cases to be recorded: shrunk ones, where there are any.
    std::map<std::size_t, std::pair<TestCase, CaseOutcome>> smallest;
  };
  // Of a case.
  WorkLimits Limits() const;
  // Gives workers a request for each chosen fault, and uses their answers. `use` returns a problem, or "".
  Result<bool> ForEachChosen(FaultWork& work, const WorkLimits& limits,
                             const std::function<nlohmann::json(std::size_t)>& request_for,
                             const std::function<std::string(std::size_t, const JsonReader&)>& use);
  Result<bool> Shrink(FaultWork& work);
  Result<bool> Keep(FaultWork& work);
  void Print(const ReportedCase& fault, const LoadedTest& test) const;
  std::string CommandOf(const LoadedTest& test, const TestCase& draws) const;
  void ShowProgress(bool end);

  const CaseSessionOptions options_;
  std::vector<LoadedTest> tests_;
  CaseReport report_;
  std::size_t current_ = 0;  // test of the next job
  std::uint64_t planned_ = 0;
  std::uint64_t done_ = 0;
  std::vector<std::pair<std::size_t, ReportedCase>> faults_;  // to be examined, with their tests
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point shown_ = began_;
  bool progress_shown_ = false;
};

}  // namespace troupe
