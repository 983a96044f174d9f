#include "worldfile/models/lanes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "worldfile/sites/site_tree.h"

namespace troupe {
namespace {

constexpr double kOneLevel = 0.5;  // m between heights that are one level

std::vector<LevelDescription> Ascending(std::vector<LevelDescription> levels) {
  std::stable_sort(levels.begin(), levels.end(), [](const auto& a, const auto& b) { return a.z < b.z; });
  std::vector<LevelDescription> ascending;
  for (LevelDescription& level : levels) {
    if (ascending.empty() || level.z - ascending.back().z >= kOneLevel) ascending.push_back(std::move(level));
  }
  return ascending;
}

// A door on a line, m from its start; nothing if the line passes beside it.
std::optional<double> CrossingAt(const Vec2& from, const Vec2& to, const Vec2& a, const Vec2& b) {
  const Vec2 way = to - from;
  const double turn = Cross(way, b - a);
  // Parallel: such a lane runs along the door, or through both its jambs, where no robot follows it.
  if (turn == 0.0) return std::nullopt;
  const double on_way = Cross(a - from, b - a) / turn;
  const double on_door = Cross(a - from, way) / turn;
  if (on_way < 0.0 || on_way > 1.0 || on_door < 0.0 || on_door > 1.0) return std::nullopt;
  return on_way * way.norm();
}

class GraphMaker {
 public:
  GraphMaker(const Site& site, const WorldDescription& world) : site_(site), world_(world), names_(PlaceNames(site)) {
    for (std::size_t i = 0; i < world.doors.size(); ++i) doors_.emplace(world.model(world.doors[i].model).name, i);
  }

  LaneGraph Make(std::uint32_t number) const {
    LaneGraph graph;
    graph.number = number;
    for (std::size_t i = 0; i < site_.levels.size(); ++i) AddLevel(i, graph);
    return graph;
  }

 private:
  void AddLevel(std::size_t number, LaneGraph& graph) const {
    const SiteLevel& level = site_.levels[number];
    // A vertex without a lane of this graph would be an unreachable goal.
    std::vector<bool> is_used(level.vertices.size(), false);
    for (const SiteLane& lane : level.lanes) {
      if (lane.graph == graph.number) is_used[lane.edge.start] = is_used[lane.edge.end] = true;
    }
    std::vector<std::uint32_t> numbers(level.vertices.size());  // in the graph, by vertex of the level
    for (std::size_t i = 0; i < is_used.size(); ++i) {
      if (!is_used[i]) continue;
      numbers[i] = static_cast<std::uint32_t>(graph.vertices.size());
      graph.vertices.push_back(MakeVertex(level, level.vertices[i], names_[number][i]));
    }
    for (const SiteLane& lane : level.lanes) {
      if (lane.graph != graph.number) continue;
      std::optional<Lane> made = MakeLane(level, lane);
      if (!made) continue;
      made->start = numbers[lane.edge.start];
      made->end = numbers[lane.edge.end];
      graph.lanes.push_back(std::move(*made));
    }
  }

  LaneVertex MakeVertex(const SiteLevel& level, const SiteVertex& vertex, const std::string& name) const {
    LaneVertex made;
    made.name = name;
    made.position = vertex.position;
    made.z = level.elevation;
    made.is_charger = vertex.is_charger;
    made.is_waiting_place = vertex.is_parking_spot || vertex.is_holding_point;
    made.dock = vertex.dock;
    made.mutex = vertex.mutex;
    const std::optional<std::size_t> lift =
        vertex.lift_cabin.empty() ? std::nullopt : FindLift(world_, vertex.lift_cabin);
    if (!lift) return made;
    const std::vector<LiftFloor>& floors = world_.lifts[*lift].floors;
    const auto floor =
        std::find_if(floors.begin(), floors.end(), [&](const auto& each) { return each.name == level.name; });
    if (floor == floors.end()) return made;
    made.lift = static_cast<std::uint32_t>(*lift);
    made.floor = static_cast<std::uint32_t>(floor - floors.begin());
    return made;
  }

  // Nothing for one that no robot can follow.
  std::optional<Lane> MakeLane(const SiteLevel& level, const SiteLane& lane) const {
    const Vec2& from = level.vertices[lane.edge.start].position;
    const Vec2& to = level.vertices[lane.edge.end].position;
    if ((to - from).norm() < 1e-6) return std::nullopt;
    Lane made;
    made.is_bidirectional = lane.is_bidirectional;
    made.speed_limit = lane.speed_limit;
    made.facing = FindByName<LaneFacing>(lane.orientation).value_or(LaneFacing::kAny);
    made.mutex = lane.mutex;
    for (const SiteDoor& door : level.doors) {
      const std::optional<double> at =
          CrossingAt(from, to, level.vertices[door.edge.start].position, level.vertices[door.edge.end].position);
      if (!at) continue;
      // A robot would wait in front of it for ever.
      if (!door.is_operated) return std::nullopt;
      const auto found = doors_.find(DoorName(level, door));
      if (found != doors_.end()) made.doors.push_back({static_cast<std::uint32_t>(found->second), *at});
    }
    std::stable_sort(made.doors.begin(), made.doors.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
    return made;
  }

  const Site& site_;
  const WorldDescription& world_;
  std::vector<std::vector<std::string>> names_;
  std::map<std::string, std::size_t> doors_;  // of the world, by name
};

}  // namespace

std::vector<LevelDescription> LevelsOf(const Site& site) {
  std::vector<LevelDescription> levels;
  for (const SiteLevel& level : site.levels) levels.push_back({level.name, level.elevation});
  return Ascending(std::move(levels));
}

std::vector<LevelDescription> LevelsOf(const std::vector<LiftDescription>& lifts) {
  std::vector<LevelDescription> levels;
  for (const LiftDescription& lift : lifts) {
    for (const LiftFloor& floor : lift.floors) levels.push_back({floor.name, floor.z});
  }
  return Ascending(std::move(levels));
}

std::vector<LaneGraph> LaneGraphsOf(const Site& site, const WorldDescription& world) {
  std::set<std::uint32_t> numbers;
  for (const SiteLevel& level : site.levels) {
    for (const SiteLane& lane : level.lanes) numbers.insert(lane.graph);
  }
  const GraphMaker maker(site, world);
  std::vector<LaneGraph> graphs;
  for (const std::uint32_t number : numbers) graphs.push_back(maker.Make(number));
  return graphs;
}

}  // namespace troupe
