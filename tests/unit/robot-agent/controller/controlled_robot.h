// A robot description with a controller, for tests: a sonar ring of 8, a scanner of 181, or neither.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robot-agent/controller/create_controller.h"
#include "tests/support/small_world.h"
#include "troupe/deterministic_math.h"

namespace troupe {

inline SensorDescription MakeSonar() {
  SensorDescription sonar;
  sonar.name = "ranger:0";
  for (int i = 0; i < 8; ++i) {
    RaySensors(sonar).push_back(
        {.X_MS = {0, 0, 0, WrapAngle(i * kPi / 4)}, .range = {0.0, 5.0}, .fov = 0.3, .samples = 1});
  }
  return sonar;
}

inline SensorDescription MakeScanner() {
  SensorDescription scanner;
  scanner.name = "ranger:0";
  RaySensors(scanner).push_back({.X_MS = {}, .range = {0.0, 8.0}, .fov = kPi, .samples = 181});
  return scanner;
}

inline RobotDescription MakeRobot(const std::string& controller, const std::string& parameters,
                                  std::vector<SensorDescription> sensors = {},
                                  DriveType drive = DriveType::kDifferential) {
  RobotDescription robot;
  robot.name = "r0";
  robot.drive.type = drive;
  robot.sensors = std::move(sensors);
  robot.controller = {controller, parameters};
  return robot;
}

inline Result<std::unique_ptr<Controller>> CreateFor(const RobotDescription& robot) {
  RobotInfo info{.robot = &robot, .parameters = robot.controller.parameters};
  for (const SensorDescription& sensor : robot.sensors) info.sensors.push_back({&sensor, {}});
  return CreateController(info, AllowedPaths::All());
}

// The reading of a ranger when `range` gives the distance at each bearing (rad, of the ranger).
template <typename RangeAtBearing>
SensorReading Read(const SensorDescription& ranger, RangeAtBearing range) {
  RangerReading reading;
  for (const RaySensorDescription& sensor : RaySensors(ranger)) {
    ScanGeometry scan{.fan = {sensor.fov, sensor.samples}, .X_RS = sensor.X_MS, .limits = sensor.range};
    for (std::size_t i = 0; i < scan.fan.count; ++i) {
      reading.ranges.push_back(sensor.range.Clamp(range(sensor.X_MS.heading + scan.fan.Bearing(i))));
      reading.intensities.push_back(1.0);
    }
    reading.geometry.Change().push_back(scan);
  }
  return {.tick = 0, .content = reading};
}

inline Observation At(Tick tick, const std::vector<SensorReading>& readings, bool stalled = false) {
  return {.tick = tick,
          .time = static_cast<double>(tick) / 10.0,
          .interval = 0.1,
          .stalled = stalled,
          .sensors = readings,
          .random_key = tick};
}

}  // namespace troupe
