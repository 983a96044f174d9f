#include "common/model/validate_site.h"

#include <algorithm>
#include <string>

#include "common/model/lane_rules.h"
#include "common/model/zones.h"
#include "troupe/polygon.h"

namespace troupe {
namespace {

std::string CheckVertex(const WorldDescription& world, const LaneVertex& vertex) {
  if (!vertex.lift) return {};
  if (*vertex.lift >= world.lifts.size()) return "its lift does not exist";
  return vertex.floor < world.lifts[*vertex.lift].floors.size() ? "" : "its lift has no such floor";
}

std::string CheckLane(const WorldDescription& world, const LaneGraph& graph, const Lane& lane) {
  if (std::max(lane.start, lane.end) >= graph.vertices.size()) return "an end of it does not exist";
  if (lane.start == lane.end) return "its ends are one vertex";
  double last = 0.0;
  for (const LaneDoor& door : lane.doors) {
    if (door.door >= world.doors.size()) return "a door of it does not exist";
    if (door.at < last) return "its doors are not in their order";
    last = door.at;
  }
  return {};
}

Error ProblemOf(const LaneGraph& graph, const std::string& part, std::size_t index, const std::string& problem) {
  return {{}, "lanes " + std::to_string(graph.number) + ": " + part + " " + std::to_string(index) + ": " + problem};
}

// One lane leads to a waiting point, and one on from it to another vertex; no ring is of waiting points alone.
std::optional<std::size_t> FindBadWaitingPoint(const LaneGraph& graph) {
  std::vector<std::size_t> in(graph.vertices.size(), 0);
  std::vector<std::size_t> out(graph.vertices.size(), 0);
  for (const Lane& lane : graph.lanes) {
    ++out[lane.start];
    ++in[lane.end];
  }
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    if (graph.vertices[i].is_between && (in[i] != 1 || out[i] != 1)) return i;
  }
  std::vector<bool> is_part(graph.lanes.size(), false);
  for (const WholeLane& lane : WholeLanesOf(graph)) {
    for (const std::uint32_t part : lane.parts) is_part[part] = true;
  }
  for (std::size_t i = 0; i < graph.lanes.size(); ++i) {
    if (!is_part[i]) return graph.lanes[i].start;
  }
  return std::nullopt;
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
  if (const std::optional<std::size_t> point = FindBadWaitingPoint(graph)) {
    return ProblemOf(graph, "vertex", *point, "it is between, but not on one lane");
  }
  return Status();
}

std::string CheckZone(const ZoneDescription& zone) {
  const Result<Polygon> outline = Normalized(zone.outline);
  if (!outline.ok() || outline.value() != zone.outline) return "its outline is no normalized polygon";
  if (zone.kind == ZoneKind::kSpeed && !(zone.speed_limit > 0.0)) return "it has no speed limit";
  if (zone.kind != ZoneKind::kCleaning) return {};
  const Rectangle box = BoundingBox(zone.outline);
  const double cells = (box.max_x - box.min_x) * (box.max_y - box.min_y) / (kCoverageCell * kCoverageCell);
  return cells <= static_cast<double>(kMaxCoverageCells) ? "" : "it is too large";
}

std::string CheckAction(const WorldDescription& world, const TimedAction& action) {
  switch (action.kind) {
    case TimedKind::kDoor:
      if (action.number >= world.doors.size()) return "its door does not exist";
      return action.value >= 0.0 && action.value <= 1.0 ? "" : "its opening is not from 0 to 1";
    case TimedKind::kLift:
      if (action.number >= world.lifts.size()) return "its lift does not exist";
      return action.value >= 0.0 && action.value < static_cast<double>(world.lifts[action.number].floors.size())
                 ? ""
                 : "its floor does not exist";
    case TimedKind::kLane:
      return action.number < CountLanes(world.lane_graphs) ? "" : "its lane does not exist";
    case TimedKind::kZone:
      return action.number < world.zones.size() ? "" : "its zone does not exist";
  }
  return "its kind is unknown";
}

// Vertices in the order of a path have lanes between them, and steps ascend.
std::string CheckTrip(const LaneTrip& trip, std::size_t vertices) {
  const auto has_vertex = [&](std::uint32_t vertex) { return vertex < vertices; };
  if (!std::all_of(trip.goals.begin(), trip.goals.end(), has_vertex)) return "a goal of it does not exist";
  if (!std::all_of(trip.path.begin(), trip.path.end(), has_vertex)) return "a vertex of its path does not exist";
  if (trip.steps.size() != trip.path.size()) return "its path has not a step for each vertex";
  for (std::size_t i = 0; i < trip.steps.size(); ++i) {
    if (i == 0 ? trip.steps[0] != 0 : trip.steps[i] <= trip.steps[i - 1]) return "its steps do not ascend from 0";
    if (i > 0 && trip.path[i] == trip.path[i - 1]) return "its path has a vertex twice, one after the other";
  }
  return {};
}

Status CheckTrips(const WorldDescription& world) {
  const std::size_t vertices = CountVertices(world.lane_graphs);
  for (std::size_t i = 0; i < world.lane_trips.size(); ++i) {
    std::string problem = CheckTrip(world.lane_trips[i], vertices);
    if (problem.empty() && i > 0 && !(world.lane_trips[i - 1].robot < world.lane_trips[i].robot)) {
      problem = "its robot is not after that of the trip before";
    }
    if (!problem.empty()) return Error{{}, "trip " + std::to_string(i) + ": " + problem};
  }
  return Status();
}

}  // namespace

Status ValidateSite(const WorldDescription& world) {
  for (std::size_t i = 0; i < world.levels.size(); ++i) {
    if (i == 0 || world.levels[i].z > world.levels[i - 1].z) continue;
    return Error{{}, "level " + std::to_string(i) + ": it is not above level " + std::to_string(i - 1)};
  }
  for (std::size_t i = 0; i < world.lane_graphs.size(); ++i) {
    const LaneGraph& graph = world.lane_graphs[i];
    if (i > 0 && graph.number <= world.lane_graphs[i - 1].number) {
      return Error{{}, "lanes " + std::to_string(graph.number) + ": they are not in the order of their numbers"};
    }
    if (Status problem = CheckGraph(world, graph); !problem.ok()) return problem;
  }
  for (std::size_t i = 0; i < world.zones.size(); ++i) {
    const std::string problem = CheckZone(world.zones[i]);
    if (!problem.empty()) return Error{{}, "zone " + std::to_string(i) + ": " + problem};
  }
  for (std::size_t i = 0; i < world.flows.size(); ++i) {
    if (world.flows[i].from == world.flows[i].to) return Error{{}, "flow " + std::to_string(i) + ": it goes nowhere"};
  }
  double last = 0.0;
  for (std::size_t i = 0; i < world.timed_actions.size(); ++i) {
    const TimedAction& action = world.timed_actions[i];
    const std::string problem = action.at < last ? "it is before the last one" : CheckAction(world, action);
    if (!problem.empty()) return Error{{}, "timed action " + std::to_string(i) + ": " + problem};
    last = action.at;
  }
  return CheckTrips(world);
}

}  // namespace troupe
