// The places of the break beams of a gripper. Private to this folder.
#pragma once

#include <vector>

#include "troupe/world_description.h"

namespace troupe {

// Two beams between the open pads, at a quarter and three quarters of their common length, at half their height.
std::vector<BreakBeam> BreakBeamsOf(const WorldDescription& world, const GripperDescription& gripper);

}  // namespace troupe
