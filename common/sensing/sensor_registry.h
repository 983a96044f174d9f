// The kinds of sensors by their type names, and the sensors of a robot.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "common/sensing/sensor.h"

namespace troupe {

struct SensorKind {
  std::string_view type;  // as TypeOf
  // REQUIRES: the mount's description is of this type.
  std::unique_ptr<const Sensor> (*make)(const SensorMount& mount);
};

std::span<const SensorKind> SensorKinds();

// Null for an unknown type.
const SensorKind* FindSensorKind(std::string_view type);

// The descriptions of all sensors of a robot: those of RobotDescription::sensors with their indices, then one for the
// break beams of each of its grippers that has any, in id order, named "<gripper>.beams".
std::vector<SensorDescription> MountedSensors(const Scene& scene, RobotId robot);

// A sensor for each description of MountedSensors.
std::vector<std::unique_ptr<const Sensor>> MakeSensors(const Scene& scene, RobotId robot);

}  // namespace troupe
