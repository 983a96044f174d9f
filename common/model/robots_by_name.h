#pragma once

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "troupe/world_description.h"

namespace troupe {

// An index of the robots that exist, for a search of many: FindRobot reads all names for each. The world must outlive
// it.
class RobotsByName {
 public:
  explicit RobotsByName(const WorldDescription& world);
  std::optional<RobotId> Find(std::string_view name) const;

 private:
  std::vector<std::pair<std::string_view, RobotId>> robots_;  // sorted
};

}  // namespace troupe
