// CaseSession: runs the cases of tests in several processes, shrinks those that fail, and keeps their recordings and
// pictures. `troupe test` and `troupe sweep` use it.
//
// This process plans and reports; workers (testing/cases/worker_pool.h) run cases, so that a case that crashes or does
// not end costs one case and not the session. Outcomes arrive in any order; faults are printed in that of cases. A
// case depends on its test and its draws only, never on the worker, the number of jobs or earlier cases: that is why a
// failing case can be repeated by one command, and shards need no coordination. What is printed, kept and searched next
// follows from the numbers of cases, too, and not from the order of their ends.
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
#include "testing/cases/case_search.h"
#include "testing/cases/kept_cases.h"
#include "testing/cases/shrink.h"
#include "testing/cases/test_file.h"
#include "testing/reports/case_report.h"
#include "troupe/result.h"

namespace troupe {

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
  bool heat = false;                       // the report has the heat maps of the tests
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
  // A case that a worker runs or will run. A case that was kept beside the design or the search has a number behind all
  // of theirs.
  struct Job {
    std::size_t test = 0;
    std::uint64_t number = 0;
    bool kept = false;  // beside the design
    TestCase draws;
    std::chrono::steady_clock::time_point began;
  };
  // The order in which cases are reported: those that were kept beside the design first.
  using Place = std::pair<bool, std::uint64_t>;  // whether it is of the design, number
  // A case of a search whose outcome waits for those of smaller numbers.
  struct Found {
    Job job;
    CaseOutcome outcome;
    double seconds = 0.0;
  };
  struct Search {
    explicit Search(const CaseDesign& design) : cases(design) {}
    CaseSearch cases;
    std::map<std::uint64_t, Found> known_cases;  // kept ones
    std::map<std::uint64_t, Found> waiting;
    std::uint64_t reported = 0;  // of its cases, the first ones
    bool ends = false;           // a case did not pass: no further one begins
  };
  // A test and the state of its cases. Lists of faults and of failing cases are bounded, their counts are not.
  struct LoadedTest {
    std::unique_ptr<TestFile> file;
    std::unique_ptr<CaseWorlds> worlds;
    std::deque<Job> first;          // that failed in earlier sessions, and have not begun
    std::size_t first_open = 0;     // of them, those that have not ended
    std::set<std::uint64_t> begun;  // of them, those of the design
    std::uint64_t next = 0;         // of the other cases of the design's shard, or of the search
    std::optional<Search> search;
    std::map<Place, TestCase> failing;     // for the file of kept cases: the first kMaxKeptCases
    std::map<Place, ReportedCase> faults;  // the first kMaxPrinted
    std::uint64_t fault_count = 0;
    std::uint64_t failing_count = 0;
  };

  Status LoadTest(const std::string& path);
  void ReadKept(LoadedTest& test);
  // Nothing: there is no case at present. A search may have one after the next outcome.
  std::optional<Job> NextJob();
  std::optional<Job> NextJobOf(std::size_t number);
  void Finish(const Job& job, CaseOutcome outcome);
  void FinishSearched(LoadedTest& test, Found found);
  void Report(const Job& job, CaseOutcome outcome, double seconds);
  void KeepFailing(const LoadedTest& test) const;
  // Of the recording and pictures of a case, in the folder of the report.
  std::string FolderOf(std::size_t test, std::uint64_t number) const;
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
  void Print(const ReportedCase& fault, const ReportedTest& test) const;
  std::string CommandOf(const LoadedTest& test, const TestCase& draws) const;
  void ShowProgress(bool end);

  const CaseSessionOptions options_;
  std::vector<LoadedTest> tests_;
  std::vector<std::string> file_names_;  // of the tests, for folders
  CaseReport report_;
  std::size_t current_ = 0;  // tests before it have no further job
  std::uint64_t planned_ = 0;
  std::uint64_t done_ = 0;
  std::vector<std::pair<std::size_t, ReportedCase>> faults_;  // to be examined, with their tests
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point shown_ = began_;
  bool progress_shown_ = false;
};

}  // namespace troupe
