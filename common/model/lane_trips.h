// How far the robots of a problem of paths have come (LaneTrip), by the state alone.
#pragma once

#include <span>

#include "troupe/site_description.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

// The row of a robot in those of a state or of a plan, ascending by robots; null: it takes no part.
const TrafficRobot* FindTrafficRobot(std::span<const TrafficRobot> rows, RobotId robot);

// All robots with a trip are at their last goals: those with a path have made all of its moves, the others want to go
// nowhere else. False for a world without trips.
bool AreTripsDone(const WorldDescription& world, const WorldState& state);

}  // namespace troupe
