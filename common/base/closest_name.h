// ClosestName: the name that a user probably meant.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

// Of the names that differ from `found` by few insertions, deletions, replacements or swaps of neighbouring characters
// (a third of the length of the longer one), the one that differs least; the first of several. Nothing if none is that
// close.
std::optional<std::string> ClosestName(std::string_view found, const std::vector<std::string>& names);

// The end of a message: "; did you mean 'speed'?", or "" without a close name.
std::string DidYouMean(std::string_view found, const std::vector<std::string>& names);

}  // namespace troupe
