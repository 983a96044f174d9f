// Maps of square cells: movingai's `.map` (Sturtevant, "Benchmarks for grid-based pathfinding", 2012), as the League of
// Robot Runners extends it, and the map strings of POGEMA (`.pogema`: a text file with one).
//
// A cell is counted as these files do: x is its column, y its row, and row 0 is the top one. In the world row 0 is at
// the greatest y: the lower left corner of the map is the origin of its model. A cell is free or blocked; robots drive
// between free cells that have a side in common.
//
// Of a `.map`: '.', 'G', 'S' (swamp, or a service point), and 'E' (an emitter) are free; '@', 'O', 'T' (trees) and 'W'
// (water) are blocked. Of a POGEMA string: '#' is blocked, all others are free: '.', '!', '@' (a possible start), '$'
// (a possible target), a letter (the start of an agent) and its capital (the target of that agent).
//
// Errors have line and column. Memory: a bit for each cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "troupe/bitmap.h"
#include "troupe/result.h"
#include "troupe/vec2.h"

namespace troupe {

struct GridCell {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  auto operator<=>(const GridCell&) const = default;
};

// Text of a cell in messages: "(5, 16)".
std::string ToString(const GridCell& cell);

// An agent of a POGEMA string.
struct GridMark {
  std::optional<GridCell> start;
  std::optional<GridCell> target;
};

struct GridMap {
  static constexpr std::uint64_t kMaxCells = 16'000'000;

  std::string file;  // in messages
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<bool> blocked;       // by row from the top
  std::map<char, GridMark> marks;  // by letter, of a POGEMA string

  bool Contains(std::int64_t x, std::int64_t y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  std::size_t IndexOf(const GridCell& cell) const { return std::size_t{cell.y} * width + cell.x; }
  bool IsFree(const GridCell& cell) const { return !blocked[IndexOf(cell)]; }
  // Of cells with a side of `size` m; in the frame of the map's lower left corner.
  Vec2 CenterOf(const GridCell& cell, double size) const {
    return {(cell.x + 0.5) * size, (static_cast<double>(height) - cell.y - 0.5) * size};
  }
  // The blocked cells as pixels.
  Bitmap ToBitmap() const;
};

// True for the endings `.map` and `.pogema`.
bool IsGridMapPath(const std::string& path);

// Reads such a file. An error of the file itself is placed at `where`, which names it.
Result<GridMap> ReadGridMap(const std::string& path, const SourceLocation& where,
                            const AllowedPaths& allowed = AllowedPaths::All());

// The same from text; `path` names it in messages.
Result<GridMap> ReadMovingaiText(const std::string& text, const std::string& path);
Result<GridMap> ReadPogemaText(const std::string& text, const std::string& path);

}  // namespace troupe
