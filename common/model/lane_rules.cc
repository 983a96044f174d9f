#include "common/model/lane_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/zones.h"
#include "troupe/check.h"

namespace troupe {
namespace {

constexpr double kSamePlace = 0.05;  // m, between ends of lanes of two graphs

bool AreAtOnePlace(const LaneVertex& a, const LaneVertex& b) {
  return (a.position - b.position).norm() < kSamePlace && std::fabs(a.z - b.z) < kSamePlace;
}

const LaneRule* RuleOf(const WorldState& state, std::uint32_t lane) {
  const auto rule = std::lower_bound(state.lane_rules.begin(), state.lane_rules.end(), lane,
                                     [](const LaneRule& a, std::uint32_t b) { return a.lane < b; });
  return rule != state.lane_rules.end() && rule->lane == lane ? &*rule : nullptr;
}

}  // namespace

NumberedLane LaneOf(const WorldDescription& world, std::size_t number) {
  const std::optional<GraphPlace> place = FindLane(world.lane_graphs, number);
  TROUPE_CHECK(place.has_value());
  return {&world.lane_graphs[place->graph], place->number};
}

std::string NameOfLane(const WorldDescription& world, std::size_t number) {
  const NumberedLane lane = LaneOf(world, number);
  const WholeLane whole = WholeLaneOf(*lane.graph, lane.lane);
  return NameOfVertex(*lane.graph, whole.start) + " - " + NameOfVertex(*lane.graph, whole.end);
}

std::optional<std::uint32_t> FindLane(const WorldDescription& world, const std::string& from, const std::string& to) {
  std::size_t first = 0;
  for (const LaneGraph& graph : world.lane_graphs) {
    for (const WholeLane& lane : WholeLanesOf(graph)) {
      const std::string start = NameOfVertex(graph, lane.start);
      const std::string end = NameOfVertex(graph, lane.end);
      if ((start == from && end == to) || (start == to && end == from)) {
        return static_cast<std::uint32_t>(first + lane.parts.front());
      }
    }
    first += graph.lanes.size();
  }
  return std::nullopt;
}

std::vector<std::uint32_t> LanesOnLine(const WorldDescription& world, std::size_t number) {
  const NumberedLane lane = LaneOf(world, number);
  const WholeLane line = WholeLaneOf(*lane.graph, lane.lane);
  const LaneVertex& from = lane.graph->vertices[line.start];
  const LaneVertex& to = lane.graph->vertices[line.end];
  std::vector<std::uint32_t> lanes;
  std::size_t first = 0;
  for (const LaneGraph& graph : world.lane_graphs) {
    for (const WholeLane& each : WholeLanesOf(graph)) {
      const LaneVertex& start = graph.vertices[each.start];
      const LaneVertex& end = graph.vertices[each.end];
      const bool is_same = AreAtOnePlace(start, from) && AreAtOnePlace(end, to);
      if (!is_same && !(AreAtOnePlace(start, to) && AreAtOnePlace(end, from))) continue;
      for (const std::uint32_t part : each.parts) lanes.push_back(static_cast<std::uint32_t>(first + part));
    }
    first += graph.lanes.size();
  }
  std::sort(lanes.begin(), lanes.end());
  return lanes;
}

std::vector<std::uint32_t> ClosedLanesFor(const WorldDescription& world, const WorldState& state,
                                          std::span<const Pose> poses, std::optional<ZoneKind> others) {
  std::vector<std::uint32_t> closed;
  for (const LaneRule& rule : state.lane_rules) {
    if (rule.speed_limit == 0.0) closed.push_back(rule.lane);
  }
  for (std::size_t i = 0; i < world.zones.size(); ++i) {
    const ZoneDescription& zone = world.zones[i];
    if ((zone.kind != ZoneKind::kKeepout && zone.kind != others) || !state.zones[i].is_on) continue;
    const auto is_in = [&](const Pose& pose) { return IsInZone(world, zone, pose.translation(), pose.z); };
    if (std::any_of(poses.begin(), poses.end(), is_in)) continue;
    std::uint32_t number = 0;
    for (const LaneGraph& graph : world.lane_graphs) {
      for (const Lane& lane : graph.lanes) {
        const LaneVertex& start = graph.vertices[lane.start];
        if (CrossesZone(world, zone, start.position, graph.vertices[lane.end].position, start.z)) {
          closed.push_back(number);
        }
        ++number;
      }
    }
  }
  std::sort(closed.begin(), closed.end());
  closed.erase(std::unique(closed.begin(), closed.end()), closed.end());
  return closed;
}

std::optional<std::size_t> FindUnreleased(const WorldDescription& world, const WorldState& state, const Pose& X_WR,
                                          const Vec2& end) {
  for (std::size_t i = 0; i < world.zones.size(); ++i) {
    const ZoneDescription& zone = world.zones[i];
    if (zone.kind != ZoneKind::kRelease || !state.zones[i].is_on) continue;
    if (IsInZone(world, zone, X_WR.translation(), X_WR.z)) continue;
    if (CrossesZone(world, zone, X_WR.translation(), end, X_WR.z)) return i;
  }
  return std::nullopt;
}

bool IsLaneClosed(const WorldDescription& world, const WorldState& state, std::uint32_t lane) {
  const LaneRule* const rule = RuleOf(state, lane);
  if (rule != nullptr && rule->speed_limit == 0.0) return true;
  const NumberedLane numbered = LaneOf(world, lane);
  for (std::size_t i = 0; i < world.zones.size(); ++i) {
    const ZoneKind kind = world.zones[i].kind;
    if ((kind != ZoneKind::kKeepout && kind != ZoneKind::kRelease) || !state.zones[i].is_on) continue;
    const LaneVertex& start = numbered.start();
    if (CrossesZone(world, world.zones[i], start.position, numbered.end().position, start.z)) return true;
  }
  return false;
}

double SpeedLimitAt(const WorldDescription& world, const WorldState& state, std::optional<std::uint32_t> lane,
                    const Vec2& point, double z) {
  double limit = std::numeric_limits<double>::infinity();
  const LaneRule* const rule = lane ? RuleOf(state, *lane) : nullptr;
  if (rule != nullptr && rule->speed_limit > 0.0) limit = rule->speed_limit;
  for (std::size_t i = 0; i < world.zones.size(); ++i) {
    const ZoneDescription& zone = world.zones[i];
    if (zone.kind != ZoneKind::kSpeed || !state.zones[i].is_on) continue;
    if (IsInZone(world, zone, point, z)) limit = std::min(limit, zone.speed_limit);
  }
  return limit;
}

}  // namespace troupe
