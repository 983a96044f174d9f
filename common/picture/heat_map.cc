#include "common/picture/heat_map.h"

#include <algorithm>
#include <cmath>

namespace troupe {

void HeatMap::Add(const WorldDescription& world, const WorldState& state) {
  interval_ = world.interval_seconds();
  if (kind_ == HeatKind::kRobots) {
    for (std::size_t i = 0; i < state.robots.size(); ++i) {
      if (RobotExists(world, RobotId(i))) Count(state.robots[i].X_WR);
    }
  } else if (kind_ == HeatKind::kPeople) {
    for (std::size_t i = 0; i < state.people.size(); ++i) {
      if (!world.model(world.people[i].root).removed && !IsAway(state.people[i])) Count(state.people[i].X_WP);
    }
  } else {
    for (const RobotWait& wait : state.waits) {
      if (wait.robot.index() < state.robots.size()) Count(state.robots[wait.robot.index()].X_WR);
    }
  }
}

void HeatMap::Count(const Pose& X_WB) {
  if (X_WB.z < heights_.first || X_WB.z >= heights_.second) return;
  const auto number = [this](double metres) { return static_cast<std::int64_t>(std::floor(metres / cell_ + 0.5)); };
  ++ticks_[{number(X_WB.x), number(X_WB.y)}];
}

double HeatMap::most() const {
  std::uint64_t most = 0;
  for (const auto& [place, ticks] : ticks_) most = std::max(most, ticks);
  return static_cast<double>(most) * interval_;
}

}  // namespace troupe
