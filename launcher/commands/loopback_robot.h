// The robot of `troupe loopback`: what the parameters of nav2_loopback_sim say of it, and its description.
#pragma once

#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

// The parameters of the node loopback_simulator with its defaults.
struct LoopbackParameters {
  double update_duration = 0.01;  // s, of a tick
  std::string base_frame = "base_footprint";
  std::string scan_frame = "base_scan";
  bool stamped_commands = true;
  double scan_period = 0.1;               // s
  double range_min = 0.05;                // m
  double range_max = 30.0;                // m
  double angle_min = -3.141592653589793;  // rad
  double angle_max = 3.141592653589793;   // rad
  double angle_increment = 0.0261;        // rad
  bool infinite_ranges = true;
  bool publishes_scan = true;
  bool publishes_map_to_odom = true;
  double speed = 1.0;  // times real time
};

// A parameter that has no effect here, or another one than there, is a warning.
struct ReadParameters {
  LoopbackParameters parameters;
  std::vector<Warning> warnings;
};

// Reads a file of ROS parameters: those of `loopback_simulator`, or of `/**`. A file without either has the defaults.
Result<ReadParameters> ReadLoopbackParameters(const std::string& path);

// The text of a URDF file: a round robot of 0.22 m with two wheels, a scanner on its top, and the frames that the
// parameters name. As there, it drives in all directions, as fast as it is told.
std::string LoopbackRobot(const LoopbackParameters& parameters);

}  // namespace troupe
