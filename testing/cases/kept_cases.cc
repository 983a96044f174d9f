#include "testing/cases/kept_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include "common/base/file.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxKeptCases = 100;
constexpr std::size_t kMaxFileBytes = 10'000'000;

}  // namespace

std::string KeptCases::PathOf(const TestFile& test) {
  return std::filesystem::path(test.path()).replace_extension(".failing").string();
}

Result<KeptCases> KeptCases::Read(const TestFile& test, std::vector<std::string>& warnings) {
  KeptCases kept;
  const std::string path = PathOf(test);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return kept;
  const Result<std::string> text = ReadWholeFile(path, kMaxFileBytes);
  if (!text.ok()) return Error{{path}, "cannot read: " + text.error().message};
  std::istringstream lines(text.value());
  std::map<std::string, std::size_t> places;  // by the text of the case
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.empty() || line.front() == '#') continue;
    Result<TestCase> draws = ParseCase(line);
    if (!draws.ok() || !test.CanMake(draws.value())) {
      warnings.push_back(
          fmt::format("{}:{}:1: warning: found {}, no case of the test any more; it is not run", path, number, line));
    } else if (places.emplace(CaseText(draws.value()), kept.cases_.size()).second) {
      kept.cases_.push_back({std::move(draws).value(), {}});
    }
  }
  // One pass over the design finds the numbers of all that have no draws of their own beside it.
  const CaseDesign& design = test.design();
  auto open = std::count_if(kept.cases_.begin(), kept.cases_.end(),
                            [&](const KeptCase& each) { return each.draws.size() == design.variations().size(); });
  for (std::uint64_t i = 0; i < design.size() && open > 0; ++i) {
    const auto place = places.find(CaseText(design.At(i)));
    if (place == places.end() || kept.cases_[place->second].number) continue;  // random designs may draw a case twice
    kept.cases_[place->second].number = i;
    --open;
  }
  return kept;
}

Status KeptCases::Write(const TestFile& test, const std::vector<TestCase>& failing) const {
  std::vector<std::string> lines;
  for (const KeptCase& kept : cases_) lines.push_back(CaseText(kept.draws));
  for (const TestCase& draws : failing) {
    const std::string line = CaseText(draws);
    if (std::find(lines.begin(), lines.end(), line) == lines.end() && lines.size() < kMaxKeptCases)
      lines.push_back(line);
  }
  std::string text = "# Cases that have failed. 'troupe test' runs them first; remove a line to forget its case.\n";
  for (const std::string& line : lines) text += line + "\n";
  const std::string path = PathOf(test);
  const Status status = WriteWholeFile(path, text);
  return status.ok() ? status : Status(Error{{path}, "cannot write: " + status.error().message});
}

}  // namespace troupe
