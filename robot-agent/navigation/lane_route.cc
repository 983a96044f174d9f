#include "robot-agent/navigation/lane_route.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace troupe {
namespace {

constexpr double kRideSeconds = 20.0;  // of a ride, beside 1 s for each m of height
constexpr double kDoorSeconds = 3.0;

// A way out of a vertex: a lane, or without one a ride in a lift.
struct Exit {
  std::size_t vertex = 0;
  std::optional<std::size_t> lane = {};
  double seconds = 0.0;
};

// Times in s at the robot's speed and the lanes' limits, with a share for doors and rides, so that a route through a
// lift competes with one around it.
std::vector<std::vector<Exit>> ExitsOf(const LaneGraph& graph, double speed, const std::vector<std::size_t>& closed) {
  const std::vector<LaneVertex>& vertices = graph.vertices;
  std::vector<std::vector<Exit>> exits(vertices.size());
  for (std::size_t i = 0; i < graph.lanes.size(); ++i) {
    if (std::find(closed.begin(), closed.end(), i) != closed.end()) continue;
    const Lane& lane = graph.lanes[i];
    const double length = (vertices[lane.end].position - vertices[lane.start].position).norm();
    const double most = lane.speed_limit > 0.0 ? std::min(speed, lane.speed_limit) : speed;
    const double seconds = length / most + kDoorSeconds * static_cast<double>(lane.doors.size());
    exits[lane.start].push_back({lane.end, i, seconds});
    if (lane.is_bidirectional) exits[lane.end].push_back({lane.start, i, seconds});
  }
  std::vector<std::size_t> in_lifts;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (vertices[i].lift) in_lifts.push_back(i);
  }
  for (const std::size_t a : in_lifts) {
    for (const std::size_t b : in_lifts) {
      if (vertices[a].lift != vertices[b].lift || vertices[a].floor == vertices[b].floor) continue;
      exits[a].push_back({b, {}, kRideSeconds + std::fabs(vertices[a].z - vertices[b].z)});
    }
  }
  return exits;
}

}  // namespace

// Dijkstra's search by time.
std::optional<LaneRoute> FastestRoute(const LaneGraph& graph, std::size_t from, std::size_t to, double speed,
                                      const std::vector<std::size_t>& closed) {
  struct Reached {
    double seconds = std::numeric_limits<double>::infinity();
    Leg by;  // the last leg
  };
  const std::vector<std::vector<Exit>> exits = ExitsOf(graph, speed, closed);
  std::vector<Reached> reached(graph.vertices.size());
  std::vector<bool> is_final(graph.vertices.size(), false);
  using Entry = std::pair<double, std::size_t>;  // s, vertex
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  reached[from].seconds = 0.0;
  open.push({0.0, from});
  while (!open.empty() && !is_final[to]) {
    const std::size_t vertex = open.top().second;
    open.pop();
    if (is_final[vertex]) continue;
    is_final[vertex] = true;
    for (const Exit& next : exits[vertex]) {
      const double seconds = reached[vertex].seconds + next.seconds;
      Reached& there = reached[next.vertex];
      // Equal times are decided by vertex numbers, so that the route is unique.
      const bool is_better = seconds < there.seconds || (seconds == there.seconds && vertex < there.by.from);
      if (is_final[next.vertex] || !is_better) continue;
      there = {seconds, {vertex, next.vertex, next.lane}};
      open.push({seconds, next.vertex});
    }
  }
  if (!is_final[to]) return std::nullopt;
  LaneRoute route;
  route.seconds = reached[to].seconds;
  for (std::size_t vertex = to; vertex != from; vertex = reached[vertex].by.from) {
    route.legs.push_back(reached[vertex].by);
  }
  std::reverse(route.legs.begin(), route.legs.end());
  return route;
}

}  // namespace troupe
