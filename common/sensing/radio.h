// The radio: receives the messages of the radios of its channel that are near enough, as RadioParameters says. A
// reading has the messages that arrive at its tick; where the antennas are then decides. A radio does not hear its own
// robot. The draw that loses a message depends on the seed, both radios, the tick and the number of the message alone.
#pragma once

#include <memory>

#include "common/sensing/sensor.h"

namespace troupe {

// REQUIRES: the description has RadioParameters.
std::unique_ptr<const Sensor> MakeRadio(const SensorMount& mount);

// The strength in dBm of a message of `radio` at a distance in m, after `losses` dB. Nearer than 1 cm as there.
double RadioStrength(const RadioParameters& radio, double distance, double losses);

}  // namespace troupe
