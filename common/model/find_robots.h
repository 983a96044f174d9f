// Robots by name, for many names: tools and ROS look up hundreds of names in worlds of thousands of robots, where one
// FindRobot for each would be their product. A removed robot has no name any more.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "troupe/world_description.h"

namespace troupe {

// FindRobot for many names at once, which reads the world's robots one time. The result is in the order of the names.
std::vector<std::optional<RobotId>> FindRobots(const WorldDescription& world, const std::vector<std::string>& names);

// Only the names of robots that exist, in their order.
std::vector<std::string> NamesThatExist(const WorldDescription& world, const std::vector<std::string>& names);

}  // namespace troupe
