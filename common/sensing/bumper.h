// The bumper: strips on a robot, each pressed while a body that collides touches it (within a millimetre) at its
// heights. A robot stops at its first contact, so a bumper on its outline is pressed exactly by its contacts there. The
// last two millimetres of a strip at either end feel nothing: neighbours share a corner.
#pragma once

#include <memory>

#include "common/sensing/sensor.h"

namespace troupe {

// REQUIRES: the description has BumperParameters.
std::unique_ptr<const Sensor> MakeBumper(const SensorMount& mount);

}  // namespace troupe
