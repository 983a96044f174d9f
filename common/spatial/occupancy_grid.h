// OccupancyGrid: the static bodies of a world at one height, as cells: the static map of a robot's navigation.
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

// Marks every cell that a static piece covers a part of, if the piece reaches through height `z` (m) and can be hit or
// seen. Spans all static pieces; empty without any. A resolution that would give more than kMaxGridCells is doubled
// until it does not.
OccupancyGrid MakeOccupancyGrid(const Scene& scene, double resolution, double z);

// The height of the world's lowest sensor with several rays, for which maps are usually made, m; 0.1 without any.
double UsualMapHeight(const Scene& scene);

}  // namespace troupe
