// The ranger: laser scanners of one plane or several, and sonar rings. Each range is the exact distance along a ray,
// horizontal or at the elevation of its plane (then also to tops, undersides and the ground), with the noise of the
// description, clamped to the limits of the ray sensor. Noise is a function of (seed, robot, sensor, ray sensor,
// tick, ray).
#pragma once

#include <memory>

#include "common/sensing/sensor.h"

namespace troupe {

// REQUIRES: the description has RangerParameters.
std::unique_ptr<const Sensor> MakeRanger(const SensorMount& mount);

}  // namespace troupe
