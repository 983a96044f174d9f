// Runs: the stretches of occupied pixels of a row.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace troupe {

// Pixels x0 <= x < x1 of a row.
struct PixelRun {
  int x0 = 0;
  int x1 = 0;
};

// Replaces `runs` by the runs of a row (Bitmap::row), from left to right. Looks at a word at a time, so that free and
// full areas cost next to nothing.
void FindRuns(std::span<const std::uint64_t> row, int width, std::vector<PixelRun>& runs);

}  // namespace troupe
