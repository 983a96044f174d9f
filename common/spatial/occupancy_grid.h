// Occupancy grids of scenes: the static map of a robot's navigation.
//
// For users who need a map in the form of ROS (nav_msgs/OccupancyGrid): topics, map files, and controllers that plan by
// the map of a program. The simulation itself does not use it: its own tests are exact.
//
// A pure function of the scene; made on demand, in time linear in the cells that pieces cover. Moving bodies and people
// are not part of it.
#pragma once

#include <cstdint>
#include <optional>

#include "common/spatial/scene.h"
#include "troupe/occupancy_grid.h"

namespace troupe {

inline constexpr std::uint64_t kMaxGridCells = 16'000'000;
inline constexpr double kDefaultGridResolution = 0.05;  // m

// Marks every cell that a static piece covers a part of, if the piece reaches through height `z` (m) and can be hit or
// seen. Spans all static pieces and, occupied or not, the images of ROS maps, whose pixels are the cells if nothing
// asks for others: an unturned map comes out as it was read. Empty without pieces and maps. `resolution` in m; nothing:
// that of the world's ROS map, or kDefaultGridResolution. A resolution that would give more than `most_cells` is
// doubled until it does not.
OccupancyGrid MakeOccupancyGrid(const Scene& scene, std::optional<double> resolution, double z,
                                std::uint64_t most_cells = kMaxGridCells);

// The height of the world's lowest sensor with several rays, for which maps are usually made, m; 0.1 without any.
double UsualMapHeight(const Scene& scene);

}  // namespace troupe
