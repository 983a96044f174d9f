// Feed any bytes to the readers of tests, of kept cases and of reports that are merged. They read files, so the bytes
// are written into a folder of this process, in which the scenario that a test may name stands, too.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/process_folder.h"
#include "fuzz/targets.h"
#include "testing/cases/kept_cases.h"
#include "testing/cases/test_file.h"
#include "testing/reports/case_report.h"

namespace troupe::fuzz {
namespace {

constexpr char kScenario[] = R"({"world": "w.world", "seed": 3, "ticks": 20,
 "robots": [{"name": "r0", "model": "position", "pose": [0, 0, 0]}, {"name": "r1", "model": "position", "pose": [1, 0, 0]}],
 "spawn": [{"count": 4, "model": "position", "name_prefix": "s", "region": [0, 0, 4, 4]}]})";

const std::filesystem::path& Folder() {
  static const struct FilledFolder : ProcessFolder {
    FilledFolder() : ProcessFolder("troupe-fuzz") { WriteText(path() / "s.json", kScenario); }
  } folder;
  return folder.path();
}

void CheckError(const Error& error) {
  Check(!error.message.empty() && !error.where.file.empty());
  Check(error.message.find('\n') == std::string::npos);
}

// A case that the generator makes is one that it could have made, and its scenario can be written and read again.
void CheckCase(const troupe::TestFile& test, const TestCase& draws) {
  Check(test.CanMake(draws));
  const Result<std::string> text = test.TextOf(draws);
  if (!text.ok()) return Check(!text.error().message.empty());
  Check(ScenarioText::Parse(text.value(), test.scenario_path()).ok());
}

}  // namespace

void TestFile(Bytes bytes) {
  const std::string text = TextOf(bytes);
  const std::size_t end = text.find('\0');
  WriteText(Folder() / "t.test.json", text.substr(0, end));
  const Result<troupe::TestFile> test = troupe::TestFile::Read((Folder() / "t.test.json").string());
  if (!test.ok()) return CheckError(test.error());
  const CaseDesign& design = test.value().design();
  Check(design.size() > 0);
  for (std::uint64_t i = 0; i < std::min<std::uint64_t>(design.size(), 4); ++i) CheckCase(test.value(), design.At(i));
  if (end == std::string::npos) return;

  const std::string kept = KeptCasesPath(test.value());
  WriteText(kept, std::string_view(text).substr(end + 1));
  std::vector<std::string> warnings;
  const Result<std::vector<KeptCase>> cases = ReadKeptCases(test.value(), warnings);
  std::filesystem::remove(kept);
  if (!cases.ok()) return CheckError(cases.error());
  for (const KeptCase& each : cases.value()) CheckCase(test.value(), each.draws);
  for (const std::string& warning : warnings) Check(!warning.empty());
}

void Report(Bytes bytes) {
  WriteText(Folder() / "cases.jsonl", TextOf(bytes));
  CaseReport report;
  const troupe::Status merged = report.Merge(Folder().string(), Folder() / "merged");
  if (!merged.ok()) return CheckError(merged.error());
  if (const troupe::Status whole = report.FinishMerge(); !whole.ok()) return Check(!whole.error().message.empty());
  static_cast<void>(report.JUnit(Folder() / "merged"));
  Check(report.Write((Folder() / "merged").string()).ok());
  std::filesystem::remove_all(Folder() / "merged");
}

}  // namespace troupe::fuzz
