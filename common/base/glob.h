// MatchesGlob: patterns of names, as users write them. No sets and no escapes: names of robots need none. Without
// recursion, so that a hostile pattern takes at most the product of the lengths.
#pragma once

#include <string_view>

namespace troupe {

// True if `pattern` is `text`, where * stands for any text and ? for any one character.
bool MatchesGlob(std::string_view pattern, std::string_view text);

}  // namespace troupe
