// OccupancyGrid: the static bodies of a world at one height, as cells (Simulation::MakeMap).
#pragma once

#include <cstdint>
#include <vector>

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

}  // namespace troupe
