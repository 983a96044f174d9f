// The contact sensor: all parts of a robot that touch another body sideways, within a millimetre.
#pragma once

#include <memory>

#include "common/sensing/sensor.h"

namespace troupe {

// REQUIRES: the description has ContactParameters.
std::unique_ptr<const Sensor> MakeContactSensor(const SensorMount& mount);

}  // namespace troupe
