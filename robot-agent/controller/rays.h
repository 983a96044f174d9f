// Rays of a ranger as seen from the robot, whatever the number and places of its sensors.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "robot-agent/controller/controller.h"

namespace troupe {

struct Ray {
  double bearing;      // rad, from the robot's heading, in (-pi, pi]
  double max_range;    // m
  std::size_t sensor;  // in the ranger
  std::size_t sample;  // in the sensor
};

// All rays of one of the robot's rangers, sensor by sensor.
std::vector<Ray> RaysOf(const RobotInfo& info, std::size_t ranger);

// The range that `reading` has for the ray (m); the ray's maximum where the reading is empty, as before the first one.
double RangeOf(const RangerReading& reading, const Ray& ray);

// The scanner-like ranger: the one with a sensor of the most samples, if any sensor has more than one.
std::optional<std::size_t> FindScanner(const RobotDescription& robot);

// The sonar-like ranger: the first one with several sensors.
std::optional<std::size_t> FindSonar(const RobotDescription& robot);

}  // namespace troupe
