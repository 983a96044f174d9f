// From a twist to the command of a drive.
#pragma once

#include "troupe/controller.h"
#include "troupe/world_description.h"

namespace troupe {

// The drive applies its own bounds. A car steers onto the arc of the twist; it cannot turn on the spot.
// REQUIRES: IsFinite(wanted).
Command CommandFromTwist(const Twist& wanted, const DriveDescription& drive);

}  // namespace troupe
