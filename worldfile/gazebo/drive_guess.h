// The drive of a robot of SDF or URDF: by its plugin, or by its wheels.
//
// Plugins: those of Gazebo and gazebo_ros for differential, skid-steered, planar (holonomic), mecanum and Ackermann
// drives, known by words of their names. Without one, wheels are links below a continuous joint with a horizontal axis
// whose lowest point is within 3 cm of the robot's lowest; a joint above a wheel that turns it about the vertical
// within limits steers it, and one without limits makes it a caster. Steered wheels make a car, wheels called mecanum
// or omni, or three wheels in three directions, a holonomic drive, others a differential one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "worldfile/gazebo/rigid_model.h"

namespace troupe {

struct DriveGuess {
  std::string type;                        // as the property `drive`: "diff", "omni" or "car"; empty: nothing drives
  double wheelbase = 0.0;                  // m, of a car; 0: not known
  std::optional<double> max_speed;         // m/s
  std::optional<double> max_turn_rate;     // rad/s; of a car rad, the steering angle
  std::optional<double> max_acceleration;  // m/s^2
  std::optional<double> max_turn_acceleration;
  std::string reason;  // "the plugin ...", "2 wheels"
};

// Whether the model has a plugin that drives it.
bool HasDrivePlugin(const RigidModel& model);

// `lowest`: m, of the robot's collisions, in M.
DriveGuess GuessDrive(const RigidModel& model, double lowest, Diagnostics& diagnostics);

// The lowest point of a link's collisions, in M; nothing without them.
std::optional<double> LowestOf(const LinkPart& link);

}  // namespace troupe
