// OccupancyGrid: what stands in a world at one height, as cells: the map that a robot's navigation starts from.
#pragma once

#include <cstdint>
#include <vector>

#include "common/spatial/scene.h"

namespace troupe {

struct OccupancyGrid {
  double resolution = 0.05;  // m, side of a cell
  double origin_x = 0.0;     // m, frame W: the corner of cell 0 with the smallest x and y
  double origin_y = 0.0;
  std::uint32_t width = 0;     // cells along x
  std::uint32_t height = 0;    // cells along y
  std::vector<bool> occupied;  // row by row, rows along x

  bool empty() const { return occupied.empty(); }
};

inline constexpr std::uint64_t kMaxGridCells = 16'000'000;

// Marks every cell of which a part is covered by something that never moves, reaches through height `z` (m), and can be
// hit or seen. Spans all that never moves; nothing if there is none. A resolution with which it had more than
// kMaxGridCells is doubled until it has not.
OccupancyGrid MakeOccupancyGrid(const Scene& scene, double resolution, double z);

// The height of the world's lowest sensor with many rays, which is the height that a map is usually made for; 0.1 m
// without any.
double UsualMapHeight(const Scene& scene);

}  // namespace troupe
