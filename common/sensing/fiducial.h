// The fiducial finder: recognizes models with a fiducial_return by a clear line of sight, exact at the finder's height.
// Any body hides the ones behind it, whatever its returns; a model is seen by its own body and the parts on it.
#pragma once

#include <memory>

#include "common/sensing/sensor.h"

namespace troupe {

// REQUIRES: the description has FiducialParameters.
std::unique_ptr<const Sensor> MakeFiducialFinder(const SensorMount& mount);

}  // namespace troupe
