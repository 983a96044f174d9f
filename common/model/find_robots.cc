#include "common/model/find_robots.h"

#include <algorithm>
#include <numeric>

namespace troupe {

std::vector<std::optional<RobotId>> FindRobots(const WorldDescription& world, const std::vector<std::string>& names) {
  std::vector<std::size_t> sorted(names.size());
  std::iota(sorted.begin(), sorted.end(), std::size_t{0});
  std::sort(sorted.begin(), sorted.end(),
            [&](std::size_t left, std::size_t right) { return names[left] < names[right]; });
  std::vector<std::optional<RobotId>> found(names.size());
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const std::string& name = world.robots[i].name;
    auto same = std::lower_bound(sorted.begin(), sorted.end(), name,
                                 [&](std::size_t left, const std::string& right) { return names[left] < right; });
    // A name may be asked for twice.
    for (; same != sorted.end() && names[*same] == name && RobotExists(world, RobotId(i)); ++same) {
      found[*same] = RobotId(i);
    }
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
