// BarredLanes: the lanes of a robot's graph that it does not begin, because an operator has closed them or a keepout
// zone is on them (common/model/lane_rules.h), and the speed that is allowed at a point.
//
// Read from the frame of the tick; found again only when a rule, a zone or the robot's place in one has changed.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "robot-agent/navigation/surroundings.h"
#include "troupe/world_state.h"

namespace troupe {

class BarredLanes {
 public:
  // True if other lanes are barred than before.
  bool Read(const Surroundings& around, RobotId own, const LaneGraph& graph);
  // Numbers in the graph, ascending.
  const std::vector<std::size_t>& lanes() const { return lanes_; }

 private:
  std::vector<LaneRule> rules_;
  std::vector<bool> zones_;  // on
  std::vector<bool> inside_;
  std::vector<std::size_t> lanes_;
};

// m/s, on a way from `point` along a unit vector: the least limit on the next half metre, of the speed zones alone or
// of a lane, too. Infinity: none.
double AllowedSpeed(const Surroundings& around, const Vec2& point, const Vec2& along, double z);
double AllowedSpeed(const Surroundings& around, std::optional<std::size_t> lane, const LaneGraph& graph,
                    const Vec2& point, const Vec2& along, double z);

}  // namespace troupe
