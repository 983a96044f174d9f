#include "testing/cases/kept_cases.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "common/base/file.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxFileBytes = 100'000'000;
constexpr const char* kHeader =
    "# Cases that have failed. 'troupe test' runs them first; remove a line to forget its case.\n";

// Calls visit(number of the line from 1, its case) for the lines that are cases of the test, and
// problem(number, what is wrong) for others.
template <typename Visit, typename Problem>
void ForEachLine(const TestFile& test, const std::string& text, const Visit& visit, const Problem& problem) {
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    constexpr const char* kSpaces = " \t\r";
    const std::size_t begin = line.find_first_not_of(kSpaces);
    if (begin == std::string::npos || line[begin] == '#') continue;
    line = line.substr(begin, line.find_last_not_of(kSpaces) + 1 - begin);
    const Result<TestCase> draws = ParseCase(line);
    std::optional<TestCase> whole;
    if (draws.ok()) whole = test.WholeCase(draws.value());
    if (!whole) {
      problem(number, fmt::format("found {}, no case of the test; it is not run", line));
      continue;
    }
    const auto is_cut = [](const DrawnValue& draw) { return draw.path == "ticks" || draw.path == "without"; };
    const auto cut = std::find_if(draws.value().begin(), draws.value().end(), is_cut);
    if (whole->size() < draws.value().size() && cut != draws.value().end()) {
      problem(number, fmt::format("found '{}', which 'vary' does not have; the whole case is run", cut->path));
    }
    visit(std::move(*whole));
  }
}

}  // namespace

std::string KeptCasesPath(const TestFile& test) {
  return std::filesystem::path(test.path()).replace_extension(".failing").string();
}

Result<std::vector<KeptCase>> ReadKeptCases(const TestFile& test, std::vector<std::string>& warnings) {
  std::vector<KeptCase> kept;
  const std::string path = KeptCasesPath(test);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return kept;
  const Result<std::string> text = ReadWholeFile(path, kMaxFileBytes);
  if (!text.ok()) return Error{{path}, "cannot read: " + text.error().message};
  std::map<std::string, std::size_t> places;  // by the text of the case
  ForEachLine(
      test, text.value(),
      [&](TestCase draws) {
        if (places.emplace(CaseText(draws), kept.size()).second) kept.push_back({std::move(draws), {}});
      },
      [&](int number, const std::string& message) {
        warnings.push_back(fmt::format("{}:{}:1: warning: {}", path, number, message));
      });
  // One pass over the design finds the numbers of all that have no draws of their own beside it.
  const CaseDesign& design = test.design();
  auto open = std::count_if(kept.begin(), kept.end(),
                            [&](const KeptCase& each) { return each.draws.size() == design.variations().size(); });
  for (std::uint64_t i = 0; i < design.size() && open > 0; ++i) {
    const auto place = places.find(CaseText(design.At(i)));
    if (place == places.end() || kept[place->second].number) continue;  // random designs may draw a case twice
    kept[place->second].number = i;
    --open;
  }
  return kept;
}

Result<std::size_t> KeepCases(const TestFile& test, const std::vector<TestCase>& failing) {
  const std::string path = KeptCasesPath(test);
  const auto fail = [&](const Error& error) { return Error{{path}, "cannot write: " + error.message, error.code}; };
  const Result<FileDescriptor> file = OpenToWrite(path, O_APPEND);
  if (!file.ok()) return fail(file.error());
  // Another shard may have added its cases since the beginning, or be about to.
  while (flock(file.value().get(), LOCK_EX) != 0) {
    if (errno != EINTR) return fail(FileError(path));
  }
  const Result<std::string> text = ReadWholeFile(path, kMaxFileBytes);
  if (!text.ok()) return fail(text.error());
  std::set<std::string> known;
  ForEachLine(
      test, text.value(), [&](const TestCase& draws) { known.insert(CaseText(draws)); }, [](int, const auto&) {});
  std::string added = text.value().empty() ? kHeader : text.value().back() == '\n' ? "" : "\n";
  const std::size_t known_before = known.size();
  std::size_t left_out = 0;
  for (const TestCase& draws : failing) {
    const std::string line = CaseText(draws);
    if (known.contains(line)) continue;
    if (known.size() >= kMaxKeptCases) {
      ++left_out;
    } else {
      known.insert(line);
      added += line + "\n";
    }
  }
  if (known.size() == known_before) return left_out;
  // The lock ends with the descriptor.
  if (!WriteAll(file.value().get(), added)) {
    const Error error = FileError(path);
    (void)ftruncate(file.value().get(), static_cast<off_t>(text.value().size()));
    return fail(error);
  }
  return left_out;
}

}  // namespace troupe
