// How much flows on the lanes of a site: the planned traffic (common/traffic/traffic_plan.h) alone, with robots that
// drive as they are let, at 0.7 m/s, and stay for 3 s at each goal. Goals are drawn from all named vertices of a graph.
//
//   traffic_flow WORLD ROBOTS [SECONDS] [SEED] [GRAPH]     WORLD: a file, or `grid:20` for 20 x 20 vertices 2 m apart
//
// Prints the robots that found a place, arrivals an hour, the longest time without one of a robot, and the time of a
// tick.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/traffic/traffic_plan.h"
#include "troupe/random.h"
#include "worldfile/load_world.h"
#include "worldfile/models/waiting_points.h"

namespace troupe {
namespace {

constexpr double kRadius = 0.35;         // m
constexpr double kSpeed = 0.7;           // m/s
constexpr double kInterval = 0.1;        // s, of a tick
constexpr double kTurnTicks = 10.0;      // of the start of a lane, from rest
constexpr std::size_t kHeldTicks = 30;   // at a goal
constexpr std::size_t kRideTicks = 210;  // of a lift

struct Robot {
  std::uint32_t at = 0;
  std::optional<std::uint32_t> goal = {};
  std::uint32_t finished = 0;
  bool moves = false;
  std::uint32_t lane = 0;
  double left = 0.0;  // ticks of its move
  double most = 1.0;  // ticks
  std::size_t held = 0;
  std::size_t arrivals = 0;
  Tick last = 0;
  Tick longest = 0;  // ticks
};

Result<LaneGraph> ReadGraph(const std::string& name, std::size_t number) {
  if (!name.starts_with("grid:")) {
    Result<LoadedWorld> loaded = LoadWorld(name);
    if (!loaded.ok()) return loaded.error();
    std::vector<LaneGraph>& graphs = loaded.value().world.lane_graphs;
    if (number >= graphs.size()) return BadInput(fmt::format("found {} graphs of lanes, expected more", graphs.size()));
    const std::vector<LaneVertex>& vertices = graphs[number].vertices;
    // Those of a world without robots on these lanes.
    if (std::none_of(vertices.begin(), vertices.end(), [](const LaneVertex& vertex) { return vertex.is_between; })) {
      AddWaitingPoints(loaded.value().world, number, kRadius);
    }
    return graphs[number];
  }
  const std::size_t width = std::max(std::strtoul(name.c_str() + 5, nullptr, 10), 2UL);
  LaneGraph graph;
  for (std::size_t i = 0; i < width * width; ++i) {
    LaneVertex vertex;
    vertex.name = fmt::format("v{}", i);
    vertex.position = {2.0 * static_cast<double>(i % width), 2.0 * static_cast<double>(i / width)};
    graph.vertices.push_back(vertex);
    Lane lane;
    lane.is_bidirectional = true;
    lane.start = static_cast<std::uint32_t>(i);
    lane.end = static_cast<std::uint32_t>(i + 1);
    if (i % width + 1 < width) graph.lanes.push_back(lane);
    lane.end = static_cast<std::uint32_t>(i + width);
    if (i + width < width * width) graph.lanes.push_back(lane);
  }
  return graph;
}

class Flow {
 public:
  Flow(LaneGraph lanes, std::uint64_t seed)
      : lanes_(std::move(lanes)),
        routes_(std::make_shared<const TrafficGraph>(std::vector{lanes_}, std::vector{kRadius})),
        seed_(seed),
        obstructed_(graph_.lanes(), false) {
    for (std::uint32_t i = 0; i < lanes_.vertices.size(); ++i) {
      const bool has_lanes = !graph_.exits(i).empty();
      if (has_lanes && !lanes_.vertices[i].name.empty() && !lanes_.vertices[i].lift) goals_.push_back(i);
    }
  }

  void Place(std::size_t count) {
    std::vector<std::uint32_t> free = goals_;
    while (robots.size() < count && !free.empty()) {
      const std::size_t choice = Draw(free.size());
      const std::uint32_t vertex = free[choice];
      robots.push_back({.at = vertex});
      const auto near = graph_.VerticesNearVertex(vertex);
      std::erase_if(free, [&](std::uint32_t other) { return std::binary_search(near.begin(), near.end(), other); });
    }
  }

  void RunTick() {
    ++tick_;
    std::vector<TrafficRequest> requests;
    for (std::size_t i = 0; i < robots.size(); ++i) {
      Advance(RobotId(i), robots[i]);
      requests.push_back(RequestOf(RobotId(i), robots[i]));
    }
    PlanTraffic(routes_, requests, obstructed_, tick_, plan_);
  }

  std::vector<Robot> robots;

 private:
  std::size_t Draw(std::size_t count) {
    return static_cast<std::size_t>(RandomUniform({seed_, draws_++}) * static_cast<double>(count));
  }

  void Advance(RobotId id, Robot& robot) {
    bool goes_on = false;
    if (robot.moves) {
      robot.left -= 1.0;
      if (robot.left > 0.0) return;
      robot.moves = false;
      ++robot.finished;
      goes_on = true;
    }
    std::size_t skipped = 0;
    for (const TrafficMove& move : plan_.moves) {
      if (move.robot != id || !move.granted) continue;
      if (goes_on && skipped++ == 0) {
        robot.at = move.to;
        continue;
      }
      robot.moves = true;
      robot.lane = move.lane;
      const double way = move.lane < lanes_.lanes.size() ? LengthOf(move.lane) / kSpeed / kInterval : kRideTicks;
      robot.left = robot.most = way + (goes_on ? 0.0 : kTurnTicks);
      return;
    }
  }

  double LengthOf(std::uint32_t lane) const { return lanes_.Way(graph_.start(lane), graph_.end(lane)).norm(); }

  TrafficRequest RequestOf(RobotId id, Robot& robot) {
    if (!robot.moves && robot.goal == robot.at) {
      if (robot.held == 0) {
        ++robot.arrivals;
        robot.longest = std::max(robot.longest, tick_ - robot.last);
        robot.last = tick_;
      }
      if (++robot.held > kHeldTicks) robot.goal.reset();
    }
    while (!robot.goal || (robot.held > kHeldTicks && robot.goal == robot.at)) robot.goal = goals_[Draw(goals_.size())];
    if (robot.goal != robot.at) robot.held = 0;
    const bool is_on_lane = robot.moves && robot.lane < lanes_.lanes.size();
    return {.robot = id,
            .at = robot.at,
            .goal = robot.goal,
            .holds = robot.held > 0,
            .finished = robot.finished,
            .driven = is_on_lane ? LengthOf(robot.lane) * (1.0 - robot.left / robot.most) : 0.0};
  }

  LaneGraph lanes_;
  TrafficRoutes routes_;
  const TrafficGraph& graph_ = routes_.graph();
  std::uint64_t seed_;
  std::uint64_t draws_ = 0;
  std::vector<std::uint32_t> goals_;
  std::vector<bool> obstructed_;
  TrafficPlan plan_;
  Tick tick_ = 0;
};

int Run(const std::vector<std::string>& words) {
  const auto number = [&](std::size_t i, double otherwise) {
    return words.size() > i ? std::strtod(words[i].c_str(), nullptr) : otherwise;
  };
  const Result<LaneGraph> graph = ReadGraph(words[0], static_cast<std::size_t>(number(4, 0.0)));
  if (!graph.ok()) {
    fmt::print(stderr, "{}\n", graph.error().message);
    return 2;
  }
  const double seconds = number(2, 3600.0);
  Flow flow(graph.value(), static_cast<std::uint64_t>(number(3, 1.0)));
  flow.Place(static_cast<std::size_t>(number(1, 1.0)));
  const auto ticks = static_cast<Tick>(seconds / kInterval);
  const auto begin = std::chrono::steady_clock::now();
  for (Tick i = 0; i < ticks; ++i) flow.RunTick();
  const std::chrono::duration<double, std::micro> lasted = std::chrono::steady_clock::now() - begin;
  std::size_t arrivals = 0;
  Tick longest = 0;
  for (const Robot& robot : flow.robots) {
    arrivals += robot.arrivals;
    longest = std::max({longest, robot.longest, ticks - robot.last});
  }
  fmt::print("{} robots: {:.0f} arrivals an hour, longest time without one {:.0f} s, {:.0f} us a tick\n",
             flow.robots.size(), static_cast<double>(arrivals) * 3600.0 / seconds,
             static_cast<double>(longest) * kInterval, lasted.count() / static_cast<double>(ticks));
  return 0;
}

}  // namespace
}  // namespace troupe

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: traffic_flow WORLD ROBOTS [SECONDS] [SEED] [GRAPH]\n");
    return 2;
  }
  return troupe::Run({argv + 1, argv + argc});
}
