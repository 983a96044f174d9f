// The state of a gripper as ROS shows it. The opening is the sum of the distances by which the two fingers can still
// close, in m for fingers that move along an axis; 0: both are fully closed.
#pragma once

#include <string>

#include "troupe/world_state.h"

namespace troupe::ros {

double LargestOpening(const WorldDescription& world, GripperId gripper);

struct GripperMotion {
  double opening = 0.0;
  double opening_rate = 0.0;  // m/s, over the last tick; negative: closing
  bool moves = false;         // a finger moved during the last tick
  bool blocked = false;       // a contact stopped a finger during the last tick
  bool clamped = false;       // an object is between the pads
};
GripperMotion MotionOf(const WorldDescription& world, GripperId gripper, const WorldState& state);

// A JSON object: {"tick": 7, "fingers": "closed", "opening": 0.1, "largest_opening": 0.3, "held": "box", "clamped":
// "box", "left_contact": "box", "right_contact": "box", "lift": 0.25, "lift_blocked": false}. Absent values are
// left out. Fingers are "open", "closing", "closed" or "opening".
std::string GripperJson(const WorldDescription& world, GripperId gripper, const WorldState& state);

}  // namespace troupe::ros
