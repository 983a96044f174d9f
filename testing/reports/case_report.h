// CaseReport: the outcomes of many cases as files: JSON lines, CSV, JUnit, plots and one page without a server.
//
// cases.jsonl has all that the other files show, but wall times, which are in JUnit alone: equal cases give equal bytes
// in whatever order they ended, since rows are kept by case number. The reports of several shards (processes, machines)
// are merged by reading their lines.
//
// Sessions have up to 10 million cases: a case that passed is kept as a small row, or as a count (CaseDetail); only
// faults keep their histories. Owned by the command, one thread. All texts in pages come from users' files and are
// escaped.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "testing/cases/case_run.h"
#include "testing/reports/heat_section.h"
#include "testing/reports/statistics.h"
#include "troupe/result.h"

namespace troupe {

// A test, as far as a report shows it.
struct ReportedTest {
  std::string path;
  std::string name;
  std::vector<std::string> vary;  // paths
  std::vector<std::string> expect;
  std::vector<std::string> formulas;  // of `expect`, with shorthands replaced
  std::vector<std::string> cover;
  std::vector<std::string> metrics;
  std::vector<std::string> units;  // of the metrics
  std::uint64_t cases = 0;         // of its design, in all shards; 0: a search, whose cases are none of it
  Shard shard = {};
  TestHeat heat = {};

  bool operator==(const ReportedTest&) const = default;
};

// All but the cases and the shard. `monitors`: of the test, on any of its worlds.
ReportedTest ReportOf(const TestFile& test, const CaseMonitors& monitors);

struct ReportedCase {
  std::uint64_t number = 0;  // in the design of the test; of a case that was kept beside the design, from that on
  bool kept = false;         // a case that failed in an earlier session, and is none of the design
  TestCase draws;
  CaseOutcome outcome = {};
  std::string command = {};    // that repeats it; empty for a case that passed
  std::string shrunk = {};     // the text of the smallest case that fails so; empty: none was made
  std::string folder = {};     // with its recording and picture, from the report's folder on; empty: none
  std::string recording = {};  // file names in it; empty: none
  std::string picture = {};
  std::string page = {};  // that shows the recording without a server
};

nlohmann::json ToJson(const ReportedTest& test);
nlohmann::json ToJson(const ReportedCase& reported);

// What failed in a case that did not pass, how to repeat it, and the files that show it, for which `report` is the
// folder of the report: a line for each.
std::vector<std::string> FaultLines(const ReportedTest& test, const ReportedCase& fault,
                                    const std::filesystem::path& report);

// Without the cases a report has only counts, in constant memory.
enum class CaseDetail : bool { kCounts, kCases };

class CaseReport {
 public:
  explicit CaseReport(CaseDetail detail = CaseDetail::kCases) : detail_(detail) {}

  // The tests in their order; cases of each are added in any order, each once, and reported by number.
  void AddTest(const ReportedTest& test);
  // The same of a test with heat maps, which are drawn in this world.
  void AddTest(const ReportedTest& test, const WorldDescription& world);
  // `test`: its index. `seconds`: wall time of the case; nothing: unknown.
  void AddCase(std::size_t test, ReportedCase reported, std::optional<double> seconds = {});
  // The heat maps of a case of the design or of a search; none: the test has none.
  void AddHeat(std::size_t test, const std::vector<HeatMap>& maps);
  // Replaces a case that was added, did not pass, and has been examined since.
  void UpdateFault(std::size_t test, const ReportedCase& reported);
  // Adds the tests and cases of the report in a folder, for a report in the folder `into`. The error: a report that is
  // none, a test that differs from one of the same path, or a shard or case that is there already.
  Status Merge(const std::string& folder, const std::filesystem::path& into);
  // After the last one. The error names the shards and cases that are missing.
  Status FinishMerge();

  std::size_t size() const { return entries_.size(); }  // tests
  const ReportedTest& test(std::size_t i) const { return entries_[i].test; }
  // Cases of the designs, and those that were kept beside them.
  std::uint64_t Count(CaseVerdict verdict) const;
  std::uint64_t CountKept(CaseVerdict verdict) const;
  bool HasKept() const;
  // Situations of `cover` that no case has reached, as "test: name".
  std::vector<std::string> Uncovered() const;

  // REQUIRES of both: the report has the cases.
  // One suite for each test; failures and errors apart. Valid by the schema of Jenkins' plugin xunit (junit-10.xsd),
  // which allows less than others. `report`: the folder of the report, for the names of files.
  std::string JUnit(const std::filesystem::path& report) const;
  // Writes cases.jsonl, cases.csv, index.html, plots (*.svg) and heat maps (*.png) into a folder, which is made.
  // Tables, plots and heat maps have the cases of the design alone.
  Status Write(const std::string& folder) const;

 private:
  // What is kept of each case is small; only cases that did not pass are kept whole.
  struct Row {
    bool kept = false;
    TestCase draws;
    CaseVerdict verdict = CaseVerdict::kNotRun;
    Tick ticks = 0;
    std::uint64_t state_hash = 0;
    std::vector<double> robustness;
    std::vector<bool> covered;
    std::vector<std::optional<double>> metrics;
    std::vector<std::uint64_t> undefined;
    std::optional<double> seconds;
  };
  using Counts = std::array<std::uint64_t, 4>;  // by verdict
  struct Entry {
    ReportedTest test;
    Counts counts{};
    Counts kept_counts{};
    std::vector<bool> covered = {};                     // by any case
    std::map<std::uint64_t, Row> rows = {};             // by number
    std::map<std::uint64_t, ReportedCase> faults = {};  // that failed or could not be run, whole
    HeatSection heat = {};
    std::set<std::uint64_t> shards = {};  // merged: their indices
  };
  static std::uint64_t Sum(const Counts& counts);

  Status AddTestOf(const ReportedTest& test);
  std::string Lines() const;
  std::string Csv(const Entry& entry) const;
  std::string Page() const;
  // `name`: of its files.
  std::string PageOf(const Entry& entry, const std::string& name) const;
  std::vector<std::string> FileNames() const;  // of the tests
  static std::uint64_t RunsOfHeat(const Entry& entry);
  static std::string MetricTable(const Entry& entry, std::size_t metric);
  // File names, behind the name of the test, and SVG.
  static std::vector<std::pair<std::string, std::string>> Plots(const Entry& entry);
  // `folder`: of the report, from the folder of this one on.
  Status AddLine(const JsonReader& json, const std::filesystem::path& folder);

  const CaseDetail detail_;
  std::vector<Entry> entries_;
};

}  // namespace troupe
