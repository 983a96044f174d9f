#include "robot-agent/navigation/planned_way.h"

#include <algorithm>
#include <utility>

namespace troupe {

PlannedWay::PlannedWay(RobotId own, const LaneGraph& graph, std::span<const LaneGraph> graphs) : own_(own) {
  first_vertex_ = static_cast<std::uint32_t>(FirstVertexOf(graphs, graph));
  first_lane_ = static_cast<std::uint32_t>(FirstLaneOf(graphs, graph));
  lane_count_ = static_cast<std::uint32_t>(graph.lanes.size());
}

void PlannedWay::Read(const WorldState& state) {
  moves_.clear();
  taken_.clear();
  const auto row = std::lower_bound(state.traffic_robots.begin(), state.traffic_robots.end(), own_,
                                    [](const TrafficRobot& a, RobotId b) { return a.robot < b; });
  takes_part_ = row != state.traffic_robots.end() && row->robot == own_;
  const bool is_first = !std::exchange(has_read_, true);
  if (!takes_part_) {
    for (const TrafficRobot& robot : state.traffic_robots) taken_.push_back(robot.at);
    for (const TrafficMove& move : state.traffic_moves) {
      if (!move.granted) break;
      taken_.push_back(move.to);
    }
    std::sort(taken_.begin(), taken_.end());
    return;
  }
  if (is_first) finished_ = row->finished;
  at_ = row->at - first_vertex_;
  for (const TrafficMove& move : state.traffic_moves) {
    if (!move.granted) break;
    if (move.robot == own_) moves_.push_back(move);
  }
  // Of a report that has not been read: a late robot of a run in real time.
  for (std::uint32_t ahead = finished_ - row->finished; ahead > 0 && !moves_.empty(); --ahead) {
    at_ = moves_.front().to - first_vertex_;
    moves_.erase(moves_.begin());
  }
}

bool PlannedWay::IsTaken(std::size_t vertex) const {
  return std::binary_search(taken_.begin(), taken_.end(), first_vertex_ + static_cast<std::uint32_t>(vertex));
}

std::vector<Leg> PlannedWay::Legs() const {
  std::vector<Leg> legs;
  std::size_t from = at_;
  for (const TrafficMove& move : moves_) {
    const std::size_t to = move.to - first_vertex_;
    const std::uint32_t lane = move.lane - first_lane_;
    // A ride has no lane, nor has the way back to the start of a move.
    const bool has_lane = lane < lane_count_ && to != from;
    legs.push_back({from, to, has_lane ? std::optional<std::size_t>(lane) : std::nullopt});
    from = to;
  }
  return legs;
}

void PlannedWay::Finish() {
  at_ = moves_.front().to - first_vertex_;
  moves_.erase(moves_.begin());
  ++finished_;
}

TrafficOrder PlannedWay::OrderFor(std::size_t at, std::optional<std::size_t> goal) const {
  const auto number = [&](std::size_t vertex) { return first_vertex_ + static_cast<std::uint32_t>(vertex); };
  return {.at = number(at), .goal = goal ? std::optional(number(*goal)) : std::nullopt, .finished = finished_};
}

}  // namespace troupe
