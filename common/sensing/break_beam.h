// Break beams: light beams across the gap of a gripper. A beam is broken by the object in it that is nearest to its
// first end (of equals the lowest id), held or not. Only objects break beams; an object that touches a beam does not.
#pragma once

#include <memory>

#include "common/sensing/sensor.h"

namespace troupe {

// REQUIRES: the description has BreakBeamParameters.
std::unique_ptr<const Sensor> MakeBreakBeams(const SensorMount& mount);

}  // namespace troupe
