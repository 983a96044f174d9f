// Graphs of lanes, and robots on them that follow a plan with delays: an oracle of its own looks whether two of them
// are where they would touch.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/traffic/traffic_plan.h"
#include "troupe/random.h"

namespace troupe {

inline constexpr double kRadius = 0.3;               // m, of all robots
inline constexpr double kClearance = 2.0 * kRadius;  // m

inline TrafficGraph GraphOf(const std::vector<LaneGraph>& graphs) {
  return TrafficGraph(graphs, std::vector<double>(graphs.size(), kRadius));
}

// Repeatable numbers.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : seed_(seed) {}
  std::size_t Below(std::size_t count) { return static_cast<std::size_t>(Next() * static_cast<double>(count)); }
  bool Chance(double share) { return Next() < share; }

 private:
  double Next() { return RandomUniform({seed_, next_++}); }
  std::uint64_t seed_;
  std::uint64_t next_ = 0;
};

class LaneDraft {
 public:
  std::uint32_t Add(double x, double y, std::string mutex = "") {
    LaneVertex vertex;
    vertex.position = {x, y};
    vertex.mutex = std::move(mutex);
    graph.vertices.push_back(vertex);
    return static_cast<std::uint32_t>(graph.vertices.size() - 1);
  }
  void Join(std::uint32_t start, std::uint32_t end, bool is_bidirectional = true) {
    Lane lane;
    lane.start = start;
    lane.end = end;
    lane.is_bidirectional = is_bidirectional;
    graph.lanes.push_back(lane);
  }
  LaneGraph graph;
};

inline LaneGraph Chain(std::uint32_t length, double spacing) {
  LaneDraft draft;
  for (std::uint32_t i = 0; i < length; ++i) draft.Add(spacing * i, 0.0);
  for (std::uint32_t i = 0; i + 1 < length; ++i) draft.Join(i, i + 1);
  return draft.graph;
}

// A grid without some of its lanes, whose vertices are all connected; a dead end at some of them.
inline LaneGraph RandomGrid(Draws& draws, std::size_t width, std::size_t height, double missing) {
  LaneDraft draft;
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) draft.Add(2.0 * static_cast<double>(x), 2.0 * static_cast<double>(y));
  }
  std::vector<std::size_t> roots(width * height);
  for (std::size_t i = 0; i < roots.size(); ++i) roots[i] = i;
  const auto find = [&](std::size_t i) {
    while (roots[i] != i) i = roots[i];
    return i;
  };
  struct Pair {
    std::size_t a, b;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < roots.size(); ++i) {
    if (i % width + 1 < width) pairs.push_back({i, i + 1});
    if (i + width < roots.size()) pairs.push_back({i, i + width});
  }
  for (std::size_t i = pairs.size(); i > 1; --i) std::swap(pairs[i - 1], pairs[draws.Below(i)]);
  for (const Pair& pair : pairs) {
    const bool connects = find(pair.a) != find(pair.b);
    if (!connects && draws.Chance(missing)) continue;
    if (connects) roots[find(pair.a)] = find(pair.b);
    draft.Join(static_cast<std::uint32_t>(pair.a), static_cast<std::uint32_t>(pair.b));
  }
  return draft.graph;
}

// Robots that move as the plan grants, each with delays of its own.
class TrafficRun {
 public:
  struct Robot {
    std::uint32_t at = 0;
    std::optional<std::uint32_t> goal = {};
    std::uint32_t finished = 0;
    std::size_t left = 0;  // ticks of the present move
    std::size_t most = 1;  // of these at its start
    bool moves = false;
    std::uint32_t lane = 0;
    std::size_t holds = 0;  // ticks at the goal
    std::size_t arrivals = 0;
    Tick since = 0;
    bool is_lost = false;     // sends no requests any more
    bool turns = false;       // it goes back to where it was
    std::size_t blocked = 0;  // ticks
  };

  TrafficRun(std::vector<LaneGraph> its_graphs, std::uint64_t seed)
      : graphs(std::move(its_graphs)),
        routes(std::make_shared<const TrafficGraph>(GraphOf(graphs))),
        draws(seed),
        obstructed(graph.lanes(), false) {}

  void Place(std::uint32_t vertex) { robots.push_back({.at = vertex}); }

  // `next_goal`(robot number) gives the next goal after an arrival; nothing: it stays without a goal.
  template <typename NextGoal>
  void RunTick(const NextGoal& next_goal) {
    std::vector<TrafficRequest> requests;
    for (std::size_t i = 0; i < robots.size(); ++i) {
      Robot& robot = robots[i];
      if (robot.is_lost) continue;
      Advance(RobotId(i), robot);
      if (!robot.moves && robot.goal == robot.at) {
        if (robot.holds == 0) {
          ++robot.arrivals;
          robot.holds = 1 + draws.Below(20);
        } else if (--robot.holds == 0) {
          robot.goal.reset();
        }
      }
      if (!robot.goal) {
        robot.goal = next_goal(i);
        robot.since = tick;
      }
      requests.push_back({.robot = RobotId(i),
                          .at = robot.at,
                          .goal = robot.goal,
                          .holds = robot.holds > 0,
                          .finished = robot.finished,
                          .driven = DrivenBy(robot),
                          .is_blocked = robot.blocked > 20});
    }
    PlanTraffic(routes, requests, obstructed, tick, plan);
    ++tick;
    Check();
  }

  std::vector<LaneGraph> graphs;
  TrafficRoutes routes;
  const TrafficGraph& graph = routes.graph();
  Draws draws;
  std::vector<bool> obstructed;
  std::vector<std::uint32_t> impassable;  // lanes on which robots stop
  TrafficPlan plan;
  std::vector<Robot> robots;
  Tick tick = 0;
  double delay = 0.1;  // of a tick, that a robot stands

 private:
  void Advance(RobotId id, Robot& robot) {
    if (draws.Chance(delay)) return;
    if (robot.moves && !robot.turns) {
      const auto is_own = [&](const TrafficMove& move) { return move.robot == id; };
      const auto present = std::find_if(plan.moves.begin(), plan.moves.end(), is_own);
      robot.turns = present != plan.moves.end() && present->to == robot.at;
      if (robot.turns) robot.left = robot.most - robot.left;
    }
    const bool is_stopped =
        std::find(impassable.begin(), impassable.end(), robot.lane) != impassable.end() && 2 * robot.left <= robot.most;
    robot.blocked = robot.moves && !robot.turns && is_stopped ? robot.blocked + 1 : 0;
    if (robot.blocked > 0) return;
    if (robot.moves && robot.left > 0) {
      --robot.left;
      return;
    }
    std::size_t skipped = 0;
    for (const TrafficMove& move : plan.moves) {
      if (move.robot != id) continue;
      if (robot.moves && skipped++ == 0) {
        // The end of the present move.
        robot.at = move.to;
        robot.moves = false;
        robot.turns = false;
        ++robot.finished;
        continue;
      }
      if (!move.granted) break;
      robot.moves = true;
      robot.lane = move.lane;
      robot.left = robot.most = 1 + draws.Below(8);
      break;
    }
  }

  // m, along its lane.
  double DrivenBy(const Robot& robot) const {
    if (!robot.moves || robot.turns) return 0.0;
    const LaneGraph& lanes = graphs.front();
    const double length = lanes.Way(graph.start(robot.lane), graph.end(robot.lane)).norm();
    return length * static_cast<double>(robot.most - robot.left) / static_cast<double>(robot.most);
  }

  struct Place_ {
    Vec2 a{0.0, 0.0};
    Vec2 b{0.0, 0.0};
    std::vector<std::string> groups;
  };

  Place_ PlaceOf(const Robot& robot) const {
    const LaneGraph& lanes = graphs.front();
    if (!robot.moves) {
      const LaneVertex& vertex = lanes.vertices[robot.at];
      return {vertex.position, vertex.position, {vertex.mutex}};
    }
    const bool is_forward = robot.at == graph.start(robot.lane);
    const LaneVertex& start = lanes.vertices[robot.at];
    const LaneVertex& end = lanes.vertices[is_forward ? graph.end(robot.lane) : graph.start(robot.lane)];
    // From where it is on, or anywhere as long as it is near the start.
    const double length = (end.position - start.position).norm();
    const double driven = DrivenBy(robot);
    if (driven < kClearance || length == 0.0) return {start.position, end.position, {start.mutex, end.mutex}};
    return {start.position + driven / length * (end.position - start.position), end.position, {end.mutex}};
  }

  // By points along the lanes: another way than that of the graph.
  static double DistanceOf(const Place_& one, const Place_& two) {
    double least = 1e9;
    for (int i = 0; i <= 8; ++i) {
      for (int k = 0; k <= 8; ++k) {
        const Vec2 p = one.a + (one.b - one.a) * (i / 8.0);
        const Vec2 q = two.a + (two.b - two.a) * (k / 8.0);
        least = std::min(least, (p - q).norm());
      }
    }
    return least;
  }

  void Check() {
    std::vector<Place_> places;
    for (const Robot& robot : robots) places.push_back(PlaceOf(robot));
    for (std::size_t i = 0; i < robots.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const Vec2 apart = places[i].a - places[k].a;
        if (apart.norm() > 8.0) continue;
        ASSERT_GE(DistanceOf(places[i], places[k]), kClearance)
            << "robots " << k << " and " << i << " at tick " << tick;
        for (const std::string& group : places[i].groups) {
          for (const std::string& other : places[k].groups) ASSERT_TRUE(group.empty() || group != other);
        }
      }
    }
  }
};

}  // namespace troupe
