// A robot description with a controller, for tests: a sonar ring of 8, a scanner of 181, or neither.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/base/deterministic_math.h"
#include "robot-agent/controller/create_controller.h"

namespace troupe {

inline RangerDescription MakeSonar() {
  RangerDescription sonar;
  sonar.name = "ranger:0";
  for (int i = 0; i < 8; ++i) {
    sonar.sensors.push_back({.X_MS = {0, 0, 0, WrapAngle(i * kPi / 4)}, .range = {0.0, 5.0}, .fov = 0.3, .samples = 1});
  }
  return sonar;
}

inline RangerDescription MakeScanner() {
  RangerDescription scanner;
  scanner.name = "ranger:0";
  scanner.sensors.push_back({.X_MS = {}, .range = {0.0, 8.0}, .fov = kPi, .samples = 181});
  return scanner;
}

inline RobotDescription MakeRobot(const std::string& controller, const std::string& parameters,
                                  std::vector<RangerDescription> rangers = {},
                                  DriveType drive = DriveType::kDifferential) {
  RobotDescription robot;
  robot.name = "r0";
  robot.drive.type = drive;
  robot.rangers = std::move(rangers);
  robot.controller = {controller, parameters};
  return robot;
}

inline Result<std::unique_ptr<Controller>> CreateFor(const RobotDescription& robot) {
  return CreateController(
      {.robot = &robot, .parameters = robot.controller.parameters, .X_RM = std::vector<Pose>(robot.rangers.size())});
}

// What a ranger reads when `range` gives the distance at each bearing (rad, of the ranger).
template <typename RangeAtBearing>
RangerReading Read(const RangerDescription& ranger, RangeAtBearing range) {
  RangerReading reading;
  for (const RaySensorDescription& sensor : ranger.sensors) {
    RangeScan scan;
    for (std::uint32_t i = 0; i < sensor.samples; ++i) {
      const double bearing = sensor.samples == 1 ? 0.0 : sensor.fov * (i / (sensor.samples - 1.0) - 0.5);
      scan.ranges.push_back(sensor.range.Clamp(range(sensor.X_MS.heading + bearing)));
      scan.intensities.push_back(1.0);
    }
    reading.scans.push_back(scan);
  }
  return reading;
}

inline Observation At(Tick tick, const std::vector<RangerReading>& readings, bool stalled = false) {
  Observation observation;
  observation.tick = tick;
  observation.interval = 0.1;
  observation.time = static_cast<double>(tick) / 10.0;
  observation.stalled = stalled;
  observation.rangers = readings;
  observation.random_key = tick;
  return observation;
}

}  // namespace troupe
