// Masks of the costmap filters of Nav2: a map of map_server whose cells are numbers from 0 to 100, as outlines and
// back.
//
// A mask with areas of one number becomes one polygon for each connected area, along the edges of its cells; an area
// with holes is cut into several. So a mask that is read and written again on the same cells is the same mask: a cell
// is in a zone if its centre is. Cells are connected by their sides.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "troupe/occupancy_grid.h"
#include "troupe/polygon.h"
#include "troupe/result.h"
#include "troupe/world_description.h"

namespace troupe {

inline constexpr std::size_t kMaxMaskAreas = 1000;
inline constexpr std::size_t kMaxMaskCorners = 5000;       // of an area
inline constexpr std::int64_t kMaxMaskCells = 16'777'216;  // of a mask

struct MaskArea {
  Polygon outline;   // m, in W: normalized (troupe/polygon.h)
  int number = 100;  // of its cells, 1 to 100
};

// The areas of a mask, by ascending numbers, and of one number from the bottom up. Unknown cells are in none. `full`:
// only those of 100, as keepout masks have them. Errors are placed at `where`, which names the file, or in the file.
Result<std::vector<MaskArea>> ReadZoneMask(const std::string& path, const SourceLocation& where,
                                           const AllowedPaths& allowed, bool full);

// The files of a mask, and what its numbers mean.
struct ZoneMask {
  std::string image;        // PGM
  std::string yaml;         // of map_server, which names the image
  double multiplier = 1.0;  // of a speed mask: m/s for each step of a number
};
// The zones of a kind, keepout or speed, that are on at load on the level of a height (m, W), on the cells of a grid.
// The numbers of a keepout mask are 0 and 100, those of a speed mask the limits in steps: 0 is none, and where zones
// overlap the least limit counts. `image_name`: for the YAML file.
ZoneMask MakeZoneMask(const WorldDescription& world, ZoneKind kind, double height, const OccupancyGrid& grid,
                      const std::string& image_name);

}  // namespace troupe
