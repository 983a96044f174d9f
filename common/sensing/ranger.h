// The ranger: laser scanners and sonar rings. Each range is the exact distance along a horizontal ray, with the noise
// of the description, clamped to the limits of the ray sensor. Noise is a function of (seed, robot, sensor, ray sensor,
// tick, ray).
#pragma once

#include <memory>

#include "common/sensing/sensor.h"

namespace troupe {

// REQUIRES: the description has RangerParameters.
std::unique_ptr<const Sensor> MakeRanger(const SensorMount& mount);

}  // namespace troupe
