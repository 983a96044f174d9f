// Drive: from a controller's command to the twist to propose.
#pragma once

#include "common/model/world_description.h"
#include "robot-agent/controller/controller.h"

namespace troupe {

// The twist that the drive reaches next towards `command`, from the twist `current` that it has; within its limits. A
// component of the command that is not finite counts as zero.
Twist DriveTowards(const DriveDescription& drive, const Twist& current, const Command& command, double seconds);

}  // namespace troupe
