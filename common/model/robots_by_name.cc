#include "common/model/robots_by_name.h"

#include <algorithm>

namespace troupe {

RobotsByName::RobotsByName(const WorldDescription& world) {
  robots_.reserve(world.robots.size());
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (RobotExists(world, RobotId(i))) robots_.emplace_back(world.robots[i].name, RobotId(i));
  }
  std::sort(robots_.begin(), robots_.end());
}

std::optional<RobotId> RobotsByName::Find(std::string_view name) const {
  const auto found = std::lower_bound(robots_.begin(), robots_.end(), name,
                                      [](const auto& robot, std::string_view wanted) { return robot.first < wanted; });
  return found != robots_.end() && found->first == name ? std::optional(found->second) : std::nullopt;
}

}  // namespace troupe
