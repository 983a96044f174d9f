// The map of a building for Open-RMF, from the file of the building: a pure function but for the drawings, whose files
// it reads. The strings and sequences live in the arena.
//
// The message is made from the file and not from the loaded world, because it has what the simulation does not need:
// lanes and their properties, names of vertices, drawings of the floor. Coordinates are in the frame of the building
// map, metres, as the loader has transformed them. Drawings travel in the message; the reader has no access to files.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "idl/ros/building_map.h"
#include "transport/dds/binding/wire.h"
#include "worldfile/sites/site.h"

namespace troupe::ros {

using BuildingMapMessage = rmf_building_map_msgs_msg_dds__BuildingMap_;

// All drawings of a map together. A message has at most 64 MiB.
inline constexpr std::size_t kMaxDrawingBytes = std::size_t{60} << 20;

// All programs in ROS read the map: so it has only drawings that are pictures (common/image), and only from the folder
// of the building and from `files`. A drawing that is not there is left out; `left_out`: is added a line for each other
// one, with the reason.
BuildingMapMessage MakeBuildingMap(const Site& site, AllowedPaths files, dds::WireArena& arena,
                                   std::vector<std::string>& left_out);

}  // namespace troupe::ros
