#include "worldfile/models/grid_lanes.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "worldfile/grids/grid_tree.h"

namespace troupe {
namespace {

constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

// By cell, the number of its vertex.
std::vector<std::uint32_t> AddGraph(const GridProblem& problem, WorldDescription& world) {
  const GridMap& map = problem.map;
  std::vector<std::uint32_t> vertex_of(map.blocked.size(), kNoVertex);
  LaneGraph graph;
  for (std::uint32_t y = 0; y < map.height; ++y) {
    for (std::uint32_t x = 0; x < map.width; ++x) {
      const GridCell cell{x, y};
      if (!map.IsFree(cell)) continue;
      vertex_of[map.IndexOf(cell)] = static_cast<std::uint32_t>(graph.vertices.size());
      LaneVertex& vertex = graph.vertices.emplace_back();
      vertex.name = VertexName(cell);
      vertex.position = map.CenterOf(cell, problem.cell);
    }
  }
  for (std::size_t i = 0; i < vertex_of.size(); ++i) {
    if (vertex_of[i] == kNoVertex) continue;
    const auto add = [&](std::size_t to) {
      if (vertex_of[to] == kNoVertex) return;
      Lane& lane = graph.lanes.emplace_back();
      lane.start = vertex_of[i];
      lane.end = vertex_of[to];
      lane.is_bidirectional = true;
    };
    if ((i + 1) % map.width != 0) add(i + 1);
    if (i + map.width < vertex_of.size()) add(i + map.width);
  }
  world.lane_graphs.push_back(std::move(graph));
  return vertex_of;
}

}  // namespace

Status AddGrid(const GridProblem& problem, WorldDescription& world) {
  const auto free = static_cast<std::size_t>(std::count(problem.map.blocked.begin(), problem.map.blocked.end(), false));
  if (free > kMaxLaneCells) {
    if (problem.agents.empty()) return Status();
    return Error{
        {problem.map.file},
        fmt::format("found {} free cells, expected at most {} for a problem with agents", free, kMaxLaneCells)};
  }
  const std::vector<std::uint32_t> vertex_of = AddGraph(problem, world);
  std::map<std::string, RobotId> robots;
  for (std::size_t i = 0; i < world.robots.size(); ++i) robots.emplace(world.robots[i].name, RobotId(i));
  for (const GridAgent& agent : problem.agents) {
    const auto robot = robots.find(agent.name);
    if (robot == robots.end()) continue;
    LaneTrip& trip = world.lane_trips.emplace_back();
    trip.robot = robot->second;
    const auto add = [&](const std::vector<GridCell>& cells, std::vector<std::uint32_t>& vertices) {
      for (const GridCell& cell : cells) vertices.push_back(vertex_of[problem.map.IndexOf(cell)]);
    };
    add(agent.goals, trip.goals);
    add(agent.path, trip.path);
    trip.steps = agent.steps;
  }
  std::sort(world.lane_trips.begin(), world.lane_trips.end(),
            [](const LaneTrip& a, const LaneTrip& b) { return a.robot < b.robot; });
  return Status();
}

}  // namespace troupe
