// Radio messages as JSON objects, which they are in ROS: texts of std_msgs/String.
#pragma once

#include <string>

#include "troupe/radio_message.h"
#include "troupe/result.h"
#include "troupe/sensor.h"
#include "troupe/world_description.h"

namespace troupe::ros {

// {"from": name, "to_all": true, "bytes": "68656c6c6f", "text": "hello", "rssi": dBm, "tick": 12}; "text" where the
// bytes are UTF-8, "range", "bearing" and "elevation" where the radio measures them.
std::string ReceptionJson(const WorldDescription& world, const RadioReception& reception);

// A message that the radio numbered `radio` is to send: {"text": "hello"} or {"bytes": "68656c6c6f"}, with {"to": name}
// to one robot. The error is a text that is no such object, or names a robot that is not there.
Result<RadioMessage> ReadRadioMessage(const WorldDescription& world, std::size_t radio, const std::string& text);

}  // namespace troupe::ros
