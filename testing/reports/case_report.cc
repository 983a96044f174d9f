#include "testing/reports/case_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>

#include "common/base/file.h"
#include "common/base/json.h"
#include "common/base/text.h"
#include "common/base/xml_text.h"
#include "testing/reports/svg_plot.h"

namespace troupe {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxLineBytes = 2'000'000'000;
constexpr std::size_t kMaxNamedShards = 20;  // in one message
constexpr std::size_t kMaxPathShown = 200;

// Quoted as RFC 4180 asks.
std::string CsvField(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::vector<std::string> Problems(const ReportedTest& test, const ReportedCase& fault) {
  std::vector<std::string> lines;
  if (!fault.outcome.error.empty()) lines.push_back(fault.outcome.error);
  for (std::size_t i = 0; i < fault.outcome.expectations.size(); ++i) {
    const ExpectationOutcome& each = fault.outcome.expectations[i];
    if (each.holds) continue;
    lines.push_back(fmt::format("{}: fails{}{}, robustness {:.4g}", test.expect[i],
                                each.cause_tick ? fmt::format(" at tick {}", *each.cause_tick) : "",
                                each.causes.empty() ? "" : fmt::format(" of {}", fmt::join(each.causes, ", ")),
                                each.robustness));
  }
  return lines;
}

// The inverses of the functions below, for the lines of a report. Other JSON is an error of the reader.

Result<ReportedTest> ReadTest(const JsonReader& reader) {
  using Texts = std::vector<std::string>;
  const auto shard = reader.Get<std::string>("shard");
  ReportedTest test = {reader.Get<std::string>("test"),    reader.Get<std::string>("name"),
                       reader.Get<Texts>("vary"),          reader.Get<Texts>("expect"),
                       reader.Get<Texts>("formulas"),      reader.Get<Texts>("cover"),
                       reader.Get<Texts>("metrics"),       reader.Get<Texts>("units"),
                       reader.Get<std::uint64_t>("cases"), ParseShard(shard).value_or(Shard())};
  if (const auto heat = reader.Find("heat")) test.heat = ReadTestHeat(*heat);  // only tests with heat maps have it
  if (!reader.ok()) return reader.status().error();
  if (!ParseShard(shard)) return BadInput("found the shard " + Quoted(shard) + ", expected I/N, for instance 2/4");
  return test;
}

// `report`: the folder of the fault's report, for the new one.
ReportedCase ReadFault(const JsonReader& fault, const std::filesystem::path& report) {
  ReportedCase reported;
  if (const auto outcome = fault.Find("outcome")) reported.outcome = ReadOutcome(*outcome);
  reported.command = fault.Get<std::string>("command");
  reported.shrunk = fault.Get<std::string>("shrunk");
  const auto folder = fault.Get<std::string>("folder");
  if (!folder.empty()) reported.folder = (report / folder).lexically_normal().string();
  reported.recording = fault.Get<std::string>("recording");
  reported.picture = fault.Get<std::string>("picture");
  fault.Read("page", reported.page);  // older files have none
  return reported;
}

// Of a case without a fault: it has passed, or was not run.
CaseOutcome ReadPassed(const JsonReader& reader) {
  CaseOutcome outcome;
  const bool passed = reader.Get<std::string>("verdict") == NameOf(CaseVerdict::kPassed);
  outcome.verdict = passed ? CaseVerdict::kPassed : CaseVerdict::kNotRun;
  outcome.ticks = reader.Get<Tick>("ticks");
  reader.ReadHash("state_hash", outcome.state_hash);
  reader.Read("covered", outcome.covered);
  for (const JsonReader& each : reader.ItemsOf("robustness")) {
    ExpectationOutcome expectation;
    expectation.holds = true;
    expectation.robustness = ReadNumber(each);
    outcome.expectations.push_back(std::move(expectation));
  }
  outcome.metrics = ReadMetrics(reader);
  outcome.undefined = reader.Get<std::vector<std::uint64_t>>("undefined");
  return outcome;
}

}  // namespace

ReportedTest ReportOf(const TestFile& test, const CaseMonitors& monitors) {
  ReportedTest reported;
  reported.path = test.path();
  reported.name = test.name();
  for (const Variation& variation : test.design().variations()) reported.vary.push_back(variation.path());
  for (std::size_t i = 0; i < test.expect().size(); ++i) {
    reported.expect.push_back(test.expect()[i].name);
    reported.formulas.push_back(monitors.expectations()[i].expectation().formula());
  }
  for (const TestClause& clause : test.cover()) reported.cover.push_back(clause.name);
  for (std::size_t i = 0; i < test.metrics().size(); ++i) {
    reported.metrics.push_back(test.metrics()[i].name);
    reported.units.push_back(monitors.metrics()[i].metric().unit());
  }
  return reported;
}

json ToJson(const ReportedTest& test) {
  json line = {{"test", test.path},         {"name", test.name},
               {"vary", test.vary},         {"expect", test.expect},
               {"formulas", test.formulas}, {"cover", test.cover},
               {"metrics", test.metrics},   {"units", test.units},
               {"cases", test.cases},       {"shard", test.shard.ToString()}};
  if (!test.heat.kinds.empty()) line["heat"] = ToJson(test.heat);
  return line;
}

json ToJson(const ReportedCase& reported) {
  return {{"outcome", ToJson(reported.outcome)},
          {"command", reported.command},
          {"shrunk", reported.shrunk},
          {"folder", reported.folder},
          {"recording", reported.recording},
          {"picture", reported.picture},
          {"page", reported.page}};
}

std::vector<std::string> FaultLines(const ReportedTest& test, const ReportedCase& fault,
                                    const std::filesystem::path& report) {
  std::vector<std::string> lines = Problems(test, fault);
  if (!fault.command.empty()) lines.push_back("repeat: " + fault.command);
  if (!fault.shrunk.empty()) lines.push_back("smallest: " + fault.shrunk);
  const auto add = [&](const char* what, const std::string& name) {
    if (!name.empty()) lines.push_back(fmt::format("{}: {}", what, (report / fault.folder / name).string()));
  };
  add("recording", fault.recording);
  add("page", fault.page);
  add("picture", fault.picture);
  return lines;
}

void CaseReport::AddTest(const ReportedTest& test) {
  entries_.push_back({test});
  entries_.back().heat = HeatSection(test.heat);
}

void CaseReport::AddTest(const ReportedTest& test, const WorldDescription& world) {
  AddTest(test);
  if (!test.heat.kinds.empty()) entries_.back().heat.SetWorld(world);
}

void CaseReport::AddHeat(std::size_t test, const std::vector<HeatMap>& maps) {
  entries_[test].heat.Add(maps);
}

// Rows are kept only for a report: a session of millions of cases otherwise needs memory for its counts alone.
void CaseReport::AddCase(std::size_t test, ReportedCase reported, std::optional<double> seconds) {
  Entry& entry = entries_[test];
  const CaseOutcome& outcome = reported.outcome;
  ++(reported.kept ? entry.kept_counts : entry.counts)[static_cast<std::size_t>(outcome.verdict)];
  entry.covered.resize(std::max(entry.covered.size(), outcome.covered.size()));
  for (std::size_t i = 0; i < outcome.covered.size(); ++i) {
    if (outcome.covered[i]) entry.covered[i] = true;
  }
  if (detail_ == CaseDetail::kCounts) return;
  Row row{reported.kept,   reported.draws,  outcome.verdict,   outcome.ticks, outcome.state_hash, {},
          outcome.covered, outcome.metrics, outcome.undefined, seconds};
  for (const ExpectationOutcome& each : outcome.expectations) row.robustness.push_back(each.robustness);
  entry.rows[reported.number] = std::move(row);
  if (outcome.verdict == CaseVerdict::kFailed || outcome.verdict == CaseVerdict::kError) {
    const std::uint64_t number = reported.number;
    entry.faults[number] = std::move(reported);
  }
}

void CaseReport::UpdateFault(std::size_t test, const ReportedCase& reported) {
  if (detail_ == CaseDetail::kCases) entries_[test].faults[reported.number] = reported;
}

std::uint64_t CaseReport::Sum(const Counts& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

std::uint64_t CaseReport::Count(CaseVerdict verdict) const {
  std::uint64_t count = 0;
  for (const Entry& entry : entries_) count += entry.counts[static_cast<std::size_t>(verdict)];
  return count;
}

std::uint64_t CaseReport::CountKept(CaseVerdict verdict) const {
  std::uint64_t count = 0;
  for (const Entry& entry : entries_) count += entry.kept_counts[static_cast<std::size_t>(verdict)];
  return count;
}

bool CaseReport::HasKept() const {
  return std::any_of(entries_.begin(), entries_.end(), [](const Entry& entry) { return Sum(entry.kept_counts) > 0; });
}

std::vector<std::string> CaseReport::Uncovered() const {
  std::vector<std::string> missing;
  for (const Entry& entry : entries_) {
    for (std::size_t i = 0; i < entry.test.cover.size(); ++i) {
      const bool reached = i < entry.covered.size() && entry.covered[i];
      if (!reached) missing.push_back(entry.test.name + ": " + entry.test.cover[i]);
    }
  }
  return missing;
}

// cases.jsonl: each test, then its cases, in the order of numbers: the same bytes for the same outcomes.
std::string CaseReport::Lines() const {
  std::string lines;
  for (const Entry& entry : entries_) {
    lines += JsonText(ToJson(entry.test)) + "\n";
    if (!entry.heat.empty()) {
      json heat = ToJson(entry.heat);
      heat["test"] = entry.test.path;
      lines += JsonText(heat) + "\n";
    }
    for (const auto& [number, row] : entry.rows) {
      json robustness = json::array();
      for (const double each : row.robustness) robustness.push_back(NumberToJson(each));
      json metrics = json::array();
      for (const std::optional<double>& metric : row.metrics) {
        metrics.push_back(metric ? NumberToJson(*metric) : json(nullptr));
      }
      json line = {{"test", entry.test.path},
                   {"number", number},
                   {"kept", row.kept},
                   {"case", CaseToJson(row.draws)},
                   {"verdict", NameOf(row.verdict)},
                   {"ticks", row.ticks},
                   {"state_hash", fmt::format("{:016x}", row.state_hash)},
                   {"robustness", std::move(robustness)},
                   {"covered", row.covered},
                   {"metrics", std::move(metrics)},
                   {"undefined", row.undefined}};
      if (const auto fault = entry.faults.find(number); fault != entry.faults.end())
        line["fault"] = ToJson(fault->second);
      lines += JsonText(line) + "\n";
    }
  }
  return lines;
}

// The lines are from other machines: each is checked.
Status CaseReport::Merge(const std::string& folder, const std::filesystem::path& into) {
  const std::string file = (std::filesystem::path(folder) / "cases.jsonl").string();
  const Result<std::string> text = ReadWholeFile(file, kMaxLineBytes);
  if (!text.ok()) return Error{{file}, "cannot read: " + text.error().message, text.error().code};
  // A report with its shards beside it can be moved: links are relative.
  std::error_code failure;
  std::filesystem::path from = std::filesystem::proximate(folder, into, failure);
  if (failure) from = std::filesystem::absolute(folder);
  std::istringstream stream(text.value());
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const JsonReader reader = JsonReader::OfText(line, "", JsonLimits::OfProcesses());
    const Status added = AddLine(reader, from);
    if (reader.ok() && added.ok()) continue;
    const Status status = reader.ok() ? added : reader.status();
    const std::string& problem = status.error().message;
    return Error{{file, number, 1},
                 reader.ok() ? problem
                             : "found no line of a report, expected one as 'troupe test' and 'troupe sweep' write (" +
                                   problem + ")"};
  }
  return {};
}

// A whole sweep, or an error that names the missing shards.
Status CaseReport::FinishMerge() {
  const auto names = [](const Entry& entry, const auto& is_meant) {
    std::vector<std::string> list;
    for (std::uint64_t index = 1; index <= entry.test.shard.count && list.size() < kMaxNamedShards; ++index) {
      if (is_meant(entry.shards.contains(index))) list.push_back(Shard{index, entry.test.shard.count}.ToString());
    }
    return fmt::format("{}", fmt::join(list, ", "));
  };
  for (Entry& entry : entries_) {
    if (entry.shards.size() < entry.test.shard.count) {
      std::string message =
          fmt::format("found no shard {} of {}, expected all", names(entry, [](bool has) { return !has; }),
                      Quoted(entry.test.path, kMaxPathShown));
      for (const Entry& other : entries_) {
        // One test that is named in two ways looks like two tests.
        if (&other == &entry || other.test.name != entry.test.name || other.test.shard.count != entry.test.shard.count)
          continue;
        message += fmt::format("; found shard {} of {}: are these two paths of one test?",
                               names(other, [](bool has) { return has; }), Quoted(other.test.path, kMaxPathShown));
        break;
      }
      return BadInput(message);
    }
    const std::uint64_t cases = Sum(entry.counts);
    if (entry.test.cases > 0 && cases != entry.test.cases) {
      return BadInput(fmt::format("found {} of the {} cases of {}, expected all", cases, entry.test.cases,
                                  Quoted(entry.test.path, kMaxPathShown)));
    }
    if (!entry.heat.empty() && entry.heat.merged() != entry.test.shard.count) {
      return BadInput(fmt::format("found heat maps of {} of the {} shards of {}, expected those of all",
                                  entry.heat.merged(), entry.test.shard.count, Quoted(entry.test.path, kMaxPathShown)));
    }
    entry.test.shard = {};
  }
  return {};
}

Status CaseReport::AddTestOf(const ReportedTest& test) {
  const auto entry =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& each) { return each.test.path == test.path; });
  const std::string path = Quoted(test.path, kMaxPathShown);
  if (entry == entries_.end()) {
    AddTest(test);
    entries_.back().shards = {test.shard.index};
    return {};
  }
  ReportedTest same = test;
  same.shard = entry->test.shard;
  if (entry->test != same) {
    return BadInput(fmt::format("found another test {} than in the folders before, expected the same", path));
  }
  if (entry->test.shard.count != test.shard.count) {
    return BadInput(fmt::format("found shard {} of {} beside shard {}, expected parts of one whole",
                                test.shard.ToString(), path, entry->test.shard.ToString()));
  }
  if (!entry->shards.insert(test.shard.index).second) {
    return BadInput(fmt::format("found shard {} of {} again, expected each once", test.shard.ToString(), path));
  }
  return {};
}

Status CaseReport::AddLine(const JsonReader& reader, const std::filesystem::path& folder) {
  if (!reader.Has("number") && !reader.Has("heat_maps")) {
    const Result<ReportedTest> test = ReadTest(reader);
    return test.ok() ? AddTestOf(test.value()) : test.error();
  }
  const auto path = reader.Get<std::string>("test");
  const auto entry =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& each) { return each.test.path == path; });
  if (entry == entries_.end()) return BadInput("found a case of an unknown test, expected its test before it");
  if (reader.Has("heat_maps")) return entry->heat.Merge(reader);
  const std::optional<JsonReader> fault = reader.Find("fault");
  ReportedCase reported = fault ? ReadFault(*fault, folder) : ReportedCase{};
  if (!fault) reported.outcome = ReadPassed(reader);
  reported.number = reader.Get<std::uint64_t>("number");
  reported.kept = reader.Get<bool>("kept");
  if (const auto draws = reader.Find("case")) reported.draws = ReadCase(*draws);
  if (!reader.ok()) return reader.status();
  if (entry->rows.contains(reported.number)) {
    return BadInput(fmt::format("found case {} of {} again, expected each case once", reported.number, Quoted(path)));
  }
  AddCase(static_cast<std::size_t>(entry - entries_.begin()), std::move(reported));
  return {};
}

std::string CaseReport::Csv(const Entry& entry) const {
  std::string csv = "case";
  for (const std::string& path : entry.test.vary) csv += "," + CsvField(path);
  csv += ",verdict,ticks,state_hash";
  for (const std::string& name : entry.test.expect) csv += "," + CsvField("robustness of " + name);
  for (const std::string& name : entry.test.cover) csv += "," + CsvField("covered: " + name);
  for (std::size_t i = 0; i < entry.test.metrics.size(); ++i) {
    const std::string& unit = entry.test.units[i];
    csv += "," + CsvField(entry.test.metrics[i] + (unit.empty() ? "" : " (" + unit + ")"));
  }
  csv += "\n";
  for (const auto& [number, row] : entry.rows) {
    if (row.kept) continue;
    csv += std::to_string(number);
    for (std::size_t i = 0; i < entry.test.vary.size(); ++i)
      csv += "," + (i < row.draws.size() ? CsvField(row.draws[i].value) : "");
    csv += fmt::format(",{},{},{:016x}", NameOf(row.verdict), row.ticks, row.state_hash);
    for (std::size_t i = 0; i < entry.test.expect.size(); ++i) {
      csv += "," + (i < row.robustness.size() ? fmt::format("{}", row.robustness[i]) : "");
    }
    for (std::size_t i = 0; i < entry.test.cover.size(); ++i)
      csv += i < row.covered.size() && row.covered[i] ? ",1" : ",0";
    for (std::size_t i = 0; i < entry.test.metrics.size(); ++i) {
      const bool known = i < row.metrics.size() && row.metrics[i];
      csv += "," + (known ? fmt::format("{}", *row.metrics[i]) : "");
    }
    csv += "\n";
  }
  return csv;
}

// In the form that Jenkins and GitLab read: failures are violated expectations, errors are cases that could not be run.
std::string CaseReport::JUnit(const std::filesystem::path& report) const {
  const auto count = [](const Entry& entry, CaseVerdict verdict) {
    const auto i = static_cast<std::size_t>(verdict);
    return entry.counts[i] + entry.kept_counts[i];
  };
  // Merged reports have no times.
  const auto time = [](const std::optional<double>& seconds) {
    return seconds ? fmt::format(" time=\"{:.3f}\"", *seconds) : "";
  };
  std::string suites;
  for (const Entry& entry : entries_) {
    std::optional<double> total;
    for (const auto& [number, row] : entry.rows) {
      if (row.seconds) total = total.value_or(0.0) + *row.seconds;
    }
    suites += fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\"{}>\n",
                          XmlText(entry.test.path), entry.rows.size(), count(entry, CaseVerdict::kFailed),
                          count(entry, CaseVerdict::kError), count(entry, CaseVerdict::kNotRun), time(total));
    for (const auto& [number, row] : entry.rows) {
      const std::string text = CaseText(row.draws);
      suites += fmt::format("    <testcase classname=\"{}\" name=\"{}\"{}", XmlText(entry.test.name),
                            XmlText((row.kept ? "kept: " : "") + (text.empty() ? "case" : text)), time(row.seconds));
      const auto fault = entry.faults.find(number);
      if (row.verdict == CaseVerdict::kNotRun) {
        suites += "><skipped message=\"not run\"/></testcase>\n";
      } else if (fault == entry.faults.end()) {
        suites += "/>\n";
      } else {
        const std::vector<std::string> lines = FaultLines(entry.test, fault->second, report);
        std::string body;
        for (const std::string& line : lines) body += XmlText(line) + "\n";
        suites += fmt::format("><{0} message=\"{1}\" type=\"{0}\">{2}</{0}></testcase>\n",
                              row.verdict == CaseVerdict::kFailed ? "failure" : "error",
                              lines.empty() ? "" : XmlText(lines.front()), body);
      }
    }
    suites += "  </testsuite>\n";
  }
  const auto total = [&](CaseVerdict verdict) { return Count(verdict) + CountKept(verdict); };
  std::uint64_t tests = 0;
  for (const Entry& entry : entries_) tests += entry.rows.size();
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites tests=\"{}\" failures=\"{}\" errors=\"{}\">\n"
      "{}</testsuites>\n",
      tests, total(CaseVerdict::kFailed), total(CaseVerdict::kError), suites);
}

std::vector<std::string> CaseReport::FileNames() const {
  std::vector<std::string> tests;
  for (const Entry& entry : entries_) tests.push_back(entry.test.path);
  return FileNamesOf(tests);
}

// The cases that have run to their ends.
std::uint64_t CaseReport::RunsOfHeat(const Entry& entry) {
  return entry.counts[static_cast<std::size_t>(CaseVerdict::kPassed)] +
         entry.counts[static_cast<std::size_t>(CaseVerdict::kFailed)];
}

// The page is last: if it is there, the files that it links to are.
Status CaseReport::Write(const std::string& folder) const {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) return Error{{folder}, "cannot make the folder: " + failure.message(), ErrorCode::kOutputFailed};
  const std::filesystem::path base(folder);
  const auto write = [&](const std::string& name, const std::string& content) -> Status {
    Status status = WriteWholeFile((base / name).string(), content);
    if (status.ok()) return status;
    return Error{{(base / name).string()}, "cannot write: " + status.error().message, ErrorCode::kOutputFailed};
  };
  if (Status error = write("cases.jsonl", Lines()); !error.ok()) return error;
  const std::vector<std::string> names = FileNames();
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const std::string csv = entries_.size() == 1 ? "cases.csv" : names[i] + ".csv";
    if (Status error = write(csv, Csv(entries_[i])); !error.ok()) return error;
    for (const auto& [name, svg] : Plots(entries_[i])) {
      if (Status error = write(names[i] + name, svg); !error.ok()) return error;
    }
    const HeatSection& heat = entries_[i].heat;
    for (const HeatMap& map : heat.maps()) {
      const Result<std::string> png = heat.Draw(map, RunsOfHeat(entries_[i]));
      if (!png.ok()) return png.error();
      if (Status error = write(names[i] + HeatSection::FileName(map), png.value()); !error.ok()) return error;
    }
  }
  return write("index.html", Page());
}

}  // namespace troupe
