#include "common/model/validate_site.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/geometry/limits.h"

namespace troupe {
namespace {

bool IsNearEnough(double number) {
  return std::abs(number) <= kMaxMagnitude;
}

std::string CheckVertex(const WorldDescription& world, const LaneVertex& vertex) {
  if (!IsNearEnough(vertex.position.x()) || !IsNearEnough(vertex.position.y()) || !IsNearEnough(vertex.z)) {
    return "it is not finite or too far away";
  }
  if (!vertex.lift) return {};
  if (*vertex.lift >= world.lifts.size()) return "its lift does not exist";
  return vertex.floor < world.lifts[*vertex.lift].floors.size() ? "" : "its lift has no such floor";
}

std::string CheckLane(const WorldDescription& world, const LaneGraph& graph, const Lane& lane) {
  if (std::max(lane.start, lane.end) >= graph.vertices.size()) return "an end of it does not exist";
  if (lane.start == lane.end) return "its ends are one vertex";
  if (!IsNearEnough(lane.speed_limit) || lane.speed_limit < 0.0) return "its speed limit is negative or too large";
  if (lane.facing > LastOf(LaneFacing())) return "the direction in which robots face does not exist";
  double last = 0.0;
  for (const LaneDoor& door : lane.doors) {
    if (door.door >= world.doors.size()) return "a door of it does not exist";
    if (!IsNearEnough(door.at) || door.at < last) return "its doors are not in their order";
    last = door.at;
  }
  return {};
}

Error ProblemOf(const LaneGraph& graph, const std::string& part, std::size_t index, const std::string& problem) {
  return {{}, "lanes " + std::to_string(graph.number) + ": " + part + " " + std::to_string(index) + ": " + problem};
}

Status CheckGraph(const WorldDescription& world, const LaneGraph& graph) {
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    const std::string problem = CheckVertex(world, graph.vertices[i]);
    if (!problem.empty()) return ProblemOf(graph, "vertex", i, problem);
  }
  for (std::size_t i = 0; i < graph.lanes.size(); ++i) {
    const std::string problem = CheckLane(world, graph, graph.lanes[i]);
    if (!problem.empty()) return ProblemOf(graph, "lane", i, problem);
  }
  return Status();
}

}  // namespace

Status ValidateSite(const WorldDescription& world) {
  for (std::size_t i = 0; i < world.levels.size(); ++i) {
    const double z = world.levels[i].z;
    if (IsNearEnough(z) && (i == 0 || z > world.levels[i - 1].z)) continue;
    return Error{{}, "level " + std::to_string(i) + ": it is too far away or not above the one before it"};
  }
  for (std::size_t i = 0; i < world.lane_graphs.size(); ++i) {
    const LaneGraph& graph = world.lane_graphs[i];
    if (i > 0 && graph.number <= world.lane_graphs[i - 1].number) {
      return Error{{}, "lanes " + std::to_string(graph.number) + ": they are not in the order of their numbers"};
    }
    if (Status problem = CheckGraph(world, graph); !problem.ok()) return problem;
  }
  return Status();
}

}  // namespace troupe
