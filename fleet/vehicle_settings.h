// What a user says of a vehicle of VDA 5050 in a scenario: the parameters of the controller `vda5050`. The controller
// and the gateway to the broker read the same text.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "fleet/order_message.h"
#include "troupe/result.h"

namespace troupe::fleet {

struct VehicleSettings {
  // Its topics and the headers of its messages.
  std::string manufacturer = "Troupe";
  std::string serial_number;   // by default the name of the robot
  std::string interface_name;  // "uagv" before 3.0, then "vda5050"
  Version version = Version::k2_1;
  std::int64_t epoch_ms = 0;  // the time of tick 0, in milliseconds since 1970-01-01 (UTC)

  std::string map;                      // the frame W, as orders name it; empty: the level of a building, or "map"
  double speed = 1.0;                   // m/s, on edges without a speed
  double turn_rate = 0.8;               // rad/s
  double tolerance = 0.1;               // m: of nodes without a deviation, and of the first node of an order
  double heading_tolerance = 0.05;      // rad: of nodes with an orientation and without a deviation
  double gap = 0.2;                     // m, its distance to the next obstacle ahead
  double blocked_after = 3.0;           // s at rest before something in the way, until it is an error
  double load_time = 3.0;               // s, of a hand-over
  double minimum_state_interval = 0.0;  // s
  double state_interval = 30.0;         // s, at the latest
  double visualization_interval = 1.0;  // s; 0: no visualization

  // "uagv/v2/Troupe/forklift_1/order"
  std::string TopicOf(std::string_view name) const;
};

// Reads a JSON object. Unknown keys, and names that a topic cannot have, are errors, which begin with "vda5050".
// `robot`: the name of the robot.
Result<VehicleSettings> ReadVehicleSettings(const std::string& parameters, std::string_view robot);

}  // namespace troupe::fleet
