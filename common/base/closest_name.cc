#include "common/base/closest_name.h"

#include <algorithm>
#include <cstddef>

namespace troupe {
namespace {

constexpr std::size_t kLongestName = 100;  // the time grows with the square; longer ones are not misspelt names

// The optimal string alignment distance, by rows.
std::size_t Distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

}  // namespace

std::optional<std::string> ClosestName(std::string_view found, const std::vector<std::string>& names) {
  if (found.size() > kLongestName) return std::nullopt;
  std::size_t least = kLongestName;
  std::optional<std::string> closest;
  for (const std::string& name : names) {
    if (name.size() > kLongestName) continue;
    const std::size_t distance = Distance(found, name);
    if (distance >= least || distance > std::max(found.size(), name.size()) / 3) continue;
    least = distance;
    closest = name;
  }
  return closest;
}

std::string DidYouMean(std::string_view found, const std::vector<std::string>& names) {
  const std::optional<std::string> closest = ClosestName(found, names);
  return closest ? "; did you mean '" + *closest + "'?" : "";
}

}  // namespace troupe
