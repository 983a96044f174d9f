// Pure functions from a world to ROS messages: its map, and markers of its blocks. As in convert.h.
#pragma once

#include <string>
#include <vector>

#include "common/spatial/occupancy_grid.h"
#include "ros/messages/messages.h"
#include "transport/dds/binding/wire.h"
#include "troupe/world_state.h"

namespace troupe::ros {

OccupancyGridMessage MakeMap(const OccupancyGrid& grid, dds::WireArena& arena);

// The static bodies in frame map, and the robots in their own frames. `robot_frames`: by robot, then by link of its
// body (RobotFrames::links); empty: no robots, or not this one. A model of more than kMaxMarkerPieces pieces is left
// out: it is a bitmap, and the map shows it. `replaces`: viewers first delete all markers of this namespace, because
// the world was replaced.
inline constexpr std::size_t kMaxMarkerPieces = 5000;
MarkerArray MakeBlockMarkers(const Scene& scene, const std::vector<std::vector<std::string>>& robot_frames,
                             dds::WireArena& arena, bool replaces = false);

// The movable objects, at their poses in `state`.
MarkerArray MakeObjectMarkers(const Scene& scene, const WorldState& state, dds::WireArena& arena,
                              bool replaces = false);

}  // namespace troupe::ros
