// JSON objects that are texts of std_msgs/String in ROS: the state of a gripper, and messages of radios.
#pragma once

#include <string>

#include "troupe/radio_message.h"
#include "troupe/result.h"
#include "troupe/sensor.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe::ros {

// The state of a gripper as ROS shows it. The opening is the sum of the distances by which the two fingers can still
// close, in m for fingers that move along an axis; 0: both are fully closed.

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

// Radio messages as JSON objects, which they are in ROS: texts of std_msgs/String.

// {"from": name, "to_all": true, "bytes": "68656c6c6f", "text": "hello", "rssi": dBm, "tick": 12}; "text" where the
// bytes are UTF-8, "range", "bearing" and "elevation" where the radio measures them.
std::string ReceptionJson(const WorldDescription& world, const RadioReception& reception);

// A message that the radio numbered `radio` is to send: {"text": "hello"} or {"bytes": "68656c6c6f"}, with {"to": name}
// to one robot. The error is a text that is no such object, or names a robot that is not there.
Result<RadioMessage> ReadRadioMessage(const WorldDescription& world, std::size_t radio, const std::string& text);

}  // namespace troupe::ros
