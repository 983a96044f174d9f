#include "robot-agent/navigation/barred_lanes.h"

#include <algorithm>
#include <span>
#include <utility>

#include "common/model/lane_rules.h"
#include "common/model/zones.h"

namespace troupe {

bool BarredLanes::Read(const Surroundings& around, RobotId own, const LaneGraph& graph) {
  const WorldDescription& world = around.world();
  const Pose& X_WR = around.PoseOf(own);
  std::vector<bool> zones;
  std::vector<bool> inside;
  for (std::size_t i = 0; i < world.zones.size(); ++i) {
    const ZoneDescription& zone = world.zones[i];
    const bool counts = zone.kind == ZoneKind::kKeepout && around.state.zones[i].is_on;
    zones.push_back(counts);
    inside.push_back(counts && IsInZone(world, zone, X_WR.translation(), X_WR.z));
  }
  if (rules_ == around.state.lane_rules && zones_ == zones && inside_ == inside) return false;
  rules_ = around.state.lane_rules;
  zones_ = std::move(zones);
  inside_ = std::move(inside);
  const std::size_t first = FirstLaneOf(world.lane_graphs, graph);
  std::vector<std::size_t> lanes;
  for (const std::uint32_t lane : ClosedLanesFor(world, around.state, std::span(&X_WR, 1))) {
    if (lane >= first && lane < first + graph.lanes.size()) lanes.push_back(lane - first);
  }
  return std::exchange(lanes_, lanes) != lanes;
}

namespace {

double SpeedAhead(const Surroundings& around, std::optional<std::uint32_t> lane, const Vec2& point, const Vec2& along,
                  double z) {
  double least = SpeedLimitAt(around.world(), around.state, lane, point, z);
  if (around.world().zones.empty()) return least;
  for (const double ahead : {0.25, 0.5}) {
    least = std::min(least, SpeedLimitAt(around.world(), around.state, lane, point + ahead * along, z));
  }
  return least;
}

}  // namespace

double AllowedSpeed(const Surroundings& around, const Vec2& point, const Vec2& along, double z) {
  return SpeedAhead(around, std::nullopt, point, along, z);
}

double AllowedSpeed(const Surroundings& around, std::optional<std::size_t> lane, const LaneGraph& graph,
                    const Vec2& point, const Vec2& along, double z) {
  std::optional<std::uint32_t> number;
  if (lane) number = static_cast<std::uint32_t>(FirstLaneOf(around.world().lane_graphs, graph) + *lane);
  return SpeedAhead(around, number, point, along, z);
}

}  // namespace troupe
