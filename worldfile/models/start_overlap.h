// Robots and objects that a world file places inside other models.
#pragma once

#include <string>
#include <vector>

#include "troupe/world_description.h"

namespace troupe {

// One message for each robot and each object that starts inside a model that it collides with: "robot 'r0' starts
// inside 'wall'". After the twentieth of a kind only their number.
std::vector<std::string> FindStartOverlaps(const WorldDescription& world);

}  // namespace troupe
