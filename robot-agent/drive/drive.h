// Drive: computes the proposed twist from a controller's command.
#pragma once

#include "troupe/controller.h"
#include "troupe/world_description.h"

namespace troupe {

// The twist (in R) that the drive reaches from its present twist `current` within `seconds` on the way to `command`,
// within its limits. A component of the command that is not finite counts as zero.
Twist DriveTowards(const DriveDescription& drive, const Twist& current, const Command& command, double seconds);

}  // namespace troupe
