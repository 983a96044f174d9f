// Converters from a world to ROS messages: its map, and the shapes of what is in it. Pure functions, as in convert.h.
#pragma once

#include <string>

#include "common/dds/wire.h"
#include "common/model/event.h"
#include "common/model/world_state.h"
#include "common/ros/messages.h"
#include "common/spatial/occupancy_grid.h"

namespace troupe::ros {

OccupancyGridMessage MakeMap(const OccupancyGrid& grid, dds::WireArena& arena);

// All that stands still in frame map, and the robots in their own frames: `robot_frames` by robot, and by link of its
// body (RobotFrames::links); empty: without robots. A model of more pieces than kMaxMarkerPieces is left out: it is a
// bitmap, and the map shows it. `replaces`: those shown before go first, because the world is another one.
inline constexpr std::size_t kMaxMarkerPieces = 5000;
MarkerArray MakeBlockMarkers(const Scene& scene, const std::vector<std::vector<std::string>>& robot_frames,
                             dds::WireArena& arena, bool replaces = false);

// The objects that can be gripped, where they are in `state`.
MarkerArray MakeObjectMarkers(const Scene& scene, const WorldState& state, dds::WireArena& arena,
                              bool replaces = false);

// A JSON object: {"tick": 7, "event": "stall_began", "robot": "r0", "other": "wall", "detail": ""}.
std::string EventJson(const WorldDescription& world, const Event& event);

}  // namespace troupe::ros
