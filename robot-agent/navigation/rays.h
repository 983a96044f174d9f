// The sensors with which controllers navigate, and the rays of a ranger in the frame of the robot, for any number and
// poses of its ray sensors.
//
// Which ranger is the best: controllers ask for one, by its shape and not by its name, so that they work on any robot.
// Rays are listed once, when a controller is made, and equal lists are shared by the robots of a swarm
// (common/base/intern.h): the list is read in each tick.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "troupe/controller.h"
#include "troupe/shared.h"

namespace troupe {

struct RangerRay {
  double bearing;     // rad, from the robot's heading, in (-pi, pi]
  double max_range;   // m
  std::size_t place;  // in RangerReading::ranges
  bool operator==(const RangerRay&) const = default;
};

// All rays of a ranger of the robot, ray sensor by ray sensor; robots that are alike share them.
// REQUIRES: sensor `ranger` is a ranger.
Shared<std::vector<RangerRay>> RaysOf(const RobotInfo& info, std::size_t ranger);

// A ray with its line in the frame R of the robot.
struct PlacedRay {
  RangerRay ray;
  Vec2 p_RO{0.0, 0.0};       // its origin
  Vec2 direction{1.0, 0.0};  // a unit vector
  bool operator==(const PlacedRay&) const = default;
};

// The same with all joints of the robot at their starts. REQUIRES: as above.
Shared<std::vector<PlacedRay>> PlacedRaysOf(const RobotInfo& info, std::size_t ranger);

// The range that `reading` has for the ray (m); the ray's maximum in an empty reading, as before the first measurement.
inline double RangeOf(const SensorReading& reading, const RangerRay& ray) {
  const RangerReading* const ranger = reading.ranger();
  return ranger != nullptr && ray.place < ranger->ranges.size() ? ranger->ranges[ray.place] : ray.max_range;
}

// The scanner-like ranger: the one with the ray sensor of the most rays, if any ray sensor has more than one.
std::optional<std::size_t> FindScanner(const RobotInfo& info);

// The sonar-like ranger: the first one with several ray sensors.
std::optional<std::size_t> FindSonar(const RobotInfo& info);

// The first ranger.
std::optional<std::size_t> FindRanger(const RobotInfo& info);

// The scanner-like ranger, else the sonar-like one, else the first one.
std::optional<std::size_t> FindBestRanger(const RobotInfo& info);

// The first fiducial finder.
std::optional<std::size_t> FindFinder(const RobotInfo& info);

}  // namespace troupe
