// Robots and objects that a world file places inside other models: a check of the file before the run.
//
// Not an error: Stage runs such worlds, and a robot may have been put against a wall on purpose. But a robot that
// starts inside a wall cannot move, which looks like a fault of its controller. Overlaps below a visible depth
// (kNoticeableDepth) are rounding of hand-written files. One index of the whole world, and one query per piece of a
// moving body.
#pragma once

#include <string>
#include <vector>

#include "troupe/world_description.h"

namespace troupe {

// One message for each robot and each object that starts inside a model that it collides with: "robot 'r0' starts
// inside 'wall'". After the twentieth of a kind only their number.
std::vector<std::string> FindStartOverlaps(const WorldDescription& world);

}  // namespace troupe
