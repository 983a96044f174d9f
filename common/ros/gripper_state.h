// A gripper as ROS is told of it. Its opening is how far its fingers can still close, together: 0 when both have closed
// all the way; in m for fingers that move along an axis.
#pragma once

#include <string>

#include "common/model/world_state.h"

namespace troupe::ros {

double LargestOpening(const WorldDescription& world, GripperId gripper);

struct GripperMotion {
  double opening = 0.0;
  double opening_rate = 0.0;  // per s, during the last tick; negative: they close
  bool moves = false;         // a finger moved in the last tick
  bool blocked = false;       // a finger was stopped by a contact in the last tick
  bool clamped = false;       // an object is between the pads
};
GripperMotion MotionOf(const WorldDescription& world, GripperId gripper, const WorldState& state);

// A JSON object: {"tick": 7, "fingers": "closed", "opening": 0.1, "largest_opening": 0.3, "held": "box", "clamped":
// "box", "left_contact": "box", "right_contact": "box", "lift": 0.25, "lift_blocked": false}. What there is not is left
// out. Fingers are "open", "closing", "closed" or "opening".
std::string GripperJson(const WorldDescription& world, GripperId gripper, const WorldState& state);

}  // namespace troupe::ros
