#include "common/model/find_robots.h"

#include <algorithm>
#include <numeric>

namespace troupe {

std::vector<std::optional<RobotId>> FindRobots(const WorldDescription& world, const std::vector<std::string>& names) {
  std::vector<std::size_t> sorted(names.size());
  std::iota(sorted.begin(), sorted.end(), std::size_t{0});
  const auto name_of = [&](std::size_t i) -> const std::string& { return names[i]; };
  std::ranges::sort(sorted, {}, name_of);
  std::vector<std::optional<RobotId>> found(names.size());
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const auto same = std::ranges::equal_range(sorted, world.robots[i].name, {}, name_of);
    if (same.empty() || !RobotExists(world, RobotId(i))) continue;
    for (const std::size_t name : same) found[name] = RobotId(i);
  }
  return found;
}

std::vector<std::string> NamesThatExist(const WorldDescription& world, const std::vector<std::string>& names) {
  const std::vector<std::optional<RobotId>> found = FindRobots(world, names);
  std::vector<std::string> existing;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (found[i]) existing.push_back(names[i]);
  }
  return existing;
}

}  // namespace troupe
