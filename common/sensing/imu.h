// The inertial measurement unit: heading, yaw rate and specific force from the executed motion of the robot and of the
// joints that carry the unit. A robot without motion measures gravity alone.
#pragma once

#include <memory>

#include "common/sensing/sensor.h"

namespace troupe {

// REQUIRES: the description has ImuParameters.
std::unique_ptr<const Sensor> MakeImu(const SensorMount& mount);

}  // namespace troupe
