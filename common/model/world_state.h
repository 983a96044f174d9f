// WorldState: everything about a world that changes, at one tick. Copyable and hashable; (description, state) is all
// that a step needs, and all that a replica or a latecomer needs.
#pragma once

#include <vector>

#include "common/base/ids.h"
#include "common/geometry/pose.h"
#include "common/model/world_description.h"

namespace troupe {

struct RobotState {
  Pose X_WR;             // of the robot's root model
  Twist twist;           // executed during the tick that ended here, in R; zero after a stall
  bool stalled = false;  // the last commanded motion was cut short by a contact
  bool operator==(const RobotState&) const = default;
};

struct WorldState {
  Tick tick = 0;
  std::vector<RobotState> robots;  // by RobotId
  bool operator==(const WorldState&) const = default;
};

// The world as loaded: tick 0, everything at rest.
WorldState InitialState(const WorldDescription& world);

}  // namespace troupe
