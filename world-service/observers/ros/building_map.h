// The map of a building for Open-RMF, from the file of the building: a pure function but for the drawings, whose files
// it reads. The strings and sequences live in the arena.
#pragma once

#include "idl/ros/building_map.h"
#include "transport/dds/binding/wire.h"
#include "worldfile/sites/site.h"

namespace troupe::ros {

using BuildingMapMessage = rmf_building_map_msgs_msg_dds__BuildingMap_;

// A drawing that is not there is left out, as any file of more than 64 MiB.
BuildingMapMessage MakeBuildingMap(const Site& site, dds::WireArena& arena);

}  // namespace troupe::ros
