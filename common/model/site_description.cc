// Queries of lane graphs. Linear searches: a graph has some hundred vertices. Of equal distances the first vertex wins.
#include "troupe/site_description.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/point_distance.h"

namespace troupe {

std::string LevelAt(std::span<const LevelDescription> levels, double z) {
  const LevelDescription* nearest = nullptr;
  for (const LevelDescription& level : levels) {
    if (nearest == nullptr || std::fabs(level.z - z) < std::fabs(nearest->z - z)) nearest = &level;
  }
  return nearest == nullptr ? "L1" : nearest->name;
}

std::optional<std::size_t> LaneGraph::Find(const std::string& name) const {
  const auto found =
      std::find_if(vertices.begin(), vertices.end(), [&](const LaneVertex& vertex) { return vertex.name == name; });
  if (name.empty() || found == vertices.end()) return std::nullopt;
  return static_cast<std::size_t>(found - vertices.begin());
}

std::optional<std::size_t> LaneGraph::LaneBetween(std::size_t from, std::size_t to) const {
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    if (lanes[i].start == from && lanes[i].end == to) return i;
    if (lanes[i].is_bidirectional && lanes[i].start == to && lanes[i].end == from) return i;
  }
  return std::nullopt;
}

namespace {

template <typename Part>
std::optional<GraphPlace> FindInGraphs(std::span<const LaneGraph> graphs, std::size_t number, Part LaneGraph::*parts) {
  for (std::size_t graph = 0; graph < graphs.size(); ++graph) {
    const std::size_t count = (graphs[graph].*parts).size();
    if (number < count) return GraphPlace{graph, number};
    number -= count;
  }
  return std::nullopt;
}

// The parts of the graphs before that of a number; of all, if there is none.
template <typename Part>
std::size_t CountBefore(std::span<const LaneGraph> graphs, std::optional<std::uint32_t> graph, Part LaneGraph::*parts) {
  std::size_t count = 0;
  for (const LaneGraph& each : graphs) {
    if (each.number == graph) break;
    count += (each.*parts).size();
  }
  return count;
}

}  // namespace

double LaneGraph::DistanceTo(const Lane& lane, const Vec2& point) const {
  return DistanceToSegment(point, vertices[lane.start].position, vertices[lane.end].position);
}

std::size_t CountVertices(std::span<const LaneGraph> graphs) {
  return CountBefore(graphs, std::nullopt, &LaneGraph::vertices);
}

std::size_t CountLanes(std::span<const LaneGraph> graphs) {
  return CountBefore(graphs, std::nullopt, &LaneGraph::lanes);
}

std::size_t FirstVertexOf(std::span<const LaneGraph> graphs, const LaneGraph& graph) {
  return CountBefore(graphs, graph.number, &LaneGraph::vertices);
}

std::size_t FirstLaneOf(std::span<const LaneGraph> graphs, const LaneGraph& graph) {
  return CountBefore(graphs, graph.number, &LaneGraph::lanes);
}

std::optional<GraphPlace> FindVertex(std::span<const LaneGraph> graphs, std::size_t vertex) {
  return FindInGraphs(graphs, vertex, &LaneGraph::vertices);
}

std::optional<GraphPlace> FindLane(std::span<const LaneGraph> graphs, std::size_t lane) {
  return FindInGraphs(graphs, lane, &LaneGraph::lanes);
}

std::string NameOfVertex(const LaneGraph& graph, std::size_t vertex) {
  const std::string& name = graph.vertices[vertex].name;
  return name.empty() ? "vertex " + std::to_string(vertex) : name;
}

std::string NameOfLane(const LaneGraph& graph, const WholeLane& lane) {
  return std::to_string(graph.number) + ": " + NameOfVertex(graph, lane.start) + " - " + NameOfVertex(graph, lane.end);
}

std::string NameOfLane(const LaneGraph& graph, std::size_t lane) {
  return NameOfLane(graph, WholeLaneOf(graph, lane));
}

// Valid graphs lead on from each waiting point, and back to a vertex of the site; others are followed as far as it
// goes.
std::vector<WholeLane> WholeLanesOf(const LaneGraph& graph) {
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> onward(graph.vertices.size(), kNone);  // by waiting point: the lane out of it
  for (std::size_t i = 0; i < graph.lanes.size(); ++i) {
    if (graph.vertices[graph.lanes[i].start].is_between) onward[graph.lanes[i].start] = i;
  }
  std::vector<WholeLane> lanes;
  for (std::size_t i = 0; i < graph.lanes.size(); ++i) {
    const Lane& lane = graph.lanes[i];
    if (graph.vertices[lane.start].is_between) continue;
    WholeLane& whole = lanes.emplace_back(WholeLane{lane.start, lane.end, {static_cast<std::uint32_t>(i)}});
    while (graph.vertices[whole.end].is_between && onward[whole.end] != kNone &&
           whole.parts.size() < graph.lanes.size()) {
      whole.parts.push_back(static_cast<std::uint32_t>(onward[whole.end]));
      whole.end = graph.lanes[whole.parts.back()].end;
    }
  }
  return lanes;
}

WholeLane WholeLaneOf(const LaneGraph& graph, std::size_t lane) {
  const auto number = static_cast<std::uint32_t>(lane);
  const Lane& part = graph.lanes[lane];
  WholeLane alone{part.start, part.end, {number}};
  if (!graph.vertices[part.start].is_between && !graph.vertices[part.end].is_between) return alone;
  for (WholeLane& whole : WholeLanesOf(graph)) {
    if (std::find(whole.parts.begin(), whole.parts.end(), number) != whole.parts.end()) return std::move(whole);
  }
  return alone;
}

std::optional<NearVertex> FindNearestVertex(const LaneGraph& graph, const Vec2& point, double z, double per_height) {
  std::optional<NearVertex> nearest;
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    const LaneVertex& vertex = graph.vertices[i];
    const double distance = (vertex.position - point).norm() + per_height * std::fabs(vertex.z - z);
    if (!nearest || distance < nearest->distance) nearest = {i, distance};
  }
  return nearest;
}

const LaneGraph* GraphAt(std::span<const LaneGraph> graphs, const Pose& X_WR) {
  const LaneGraph* found = nullptr;
  double least = 0.0;
  for (const LaneGraph& graph : graphs) {
    const std::optional<NearVertex> near = FindNearestVertex(graph, X_WR.translation(), X_WR.z, kOnOneLevel);
    if (!near || (found != nullptr && near->distance >= least)) continue;
    found = &graph;
    least = near->distance;
  }
  return found;
}

const LaneGraph* FindGraph(std::span<const LaneGraph> graphs, std::uint32_t number) {
  const auto found =
      std::find_if(graphs.begin(), graphs.end(), [&](const auto& graph) { return graph.number == number; });
  return found == graphs.end() ? nullptr : &*found;
}

}  // namespace troupe
