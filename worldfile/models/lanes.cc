#include "worldfile/models/lanes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "worldfile/sites/site_tree.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr double kSliding = 0.1;  // m, that a leaf reaches out of its door

// A door on a line, m from its start; nothing if the line passes beside it.
std::optional<double> CrossingAt(const Vec2& from, const Vec2& to, const Vec2& a, const Vec2& b) {
  const Vec2 way = to - from;
  const double turn = Cross(way, b - a);
  if (turn == 0.0) return std::nullopt;
  const double on_way = Cross(a - from, b - a) / turn;
  const double on_door = Cross(a - from, way) / turn;
  if (on_way < 0.0 || on_way > 1.0 || on_door < 0.0 || on_door > 1.0) return std::nullopt;
  return on_way * way.norm();
}

double ReachOf(const SiteDoor& door, double width) {
  switch (door.kind) {
    case SiteDoorKind::kHinged:
      return width;
    case SiteDoorKind::kDoubleHinged:
      return width * std::max(1.0, door.right_left_ratio) / (1.0 + door.right_left_ratio);
    case SiteDoorKind::kSliding:
    case SiteDoorKind::kDoubleSliding:
      break;
  }
  return kSliding;
}

class GraphMaker {
 public:
  GraphMaker(const Site& site, const WorldDescription& world) : site_(site), world_(world), names_(PlaceNames(site)) {}

  // Nothing if no lane of the building has the number.
  const std::optional<Json>& Get(std::uint32_t number) {
    const auto [entry, is_new] = graphs_.try_emplace(number);
    if (is_new) entry->second = Make(number);
    return entry->second;
  }

  // The graph of the lane whose end is nearest to a pose, of several the first; on the pose's level, if there is one.
  std::uint32_t NumberAt(const Pose& X_WR) const {
    std::uint32_t number = 0;
    double least = std::numeric_limits<double>::infinity();
    for (const SiteLevel& level : site_.levels) {
      for (const SiteLane& lane : level.lanes) {
        for (const std::size_t end : {lane.edge.start, lane.edge.end}) {
          constexpr double kOtherLevel = 1000.0;  // m, for each m of height
          const double distance = (level.vertices[end].position - X_WR.translation()).norm() +
                                  kOtherLevel * std::fabs(level.elevation - X_WR.z);
          if (distance >= least) continue;
          least = distance;
          number = lane.graph;
        }
      }
    }
    return number;
  }

 private:
  const LiftDescription* FindOperatedLift(const std::string& name) const {
    const std::optional<std::size_t> number = name.empty() ? std::nullopt : FindLift(world_, name);
    return number ? &world_.lifts[*number] : nullptr;
  }

  static const LiftFloor* FindFloor(const LiftDescription& lift, const std::string& name) {
    for (const LiftFloor& floor : lift.floors) {
      if (floor.name == name) return &floor;
    }
    return nullptr;
  }

  Json MakeVertex(const SiteLevel& level, std::size_t number, const std::string& name) const {
    const SiteVertex& vertex = level.vertices[number];
    Json made{{"at", {vertex.position.x(), vertex.position.y(), level.elevation}}};
    const auto add = [&](const char* key, const std::string& text) {
      if (!text.empty()) made[key] = text;
    };
    add("name", name);
    add("dock", vertex.dock);
    add("mutex", vertex.mutex);
    if (vertex.is_charger) made["charger"] = true;
    const LiftDescription* const lift = FindOperatedLift(vertex.lift_cabin);
    const LiftFloor* const floor = lift == nullptr ? nullptr : FindFloor(*lift, level.name);
    if (floor == nullptr) return made;
    made["lift"] = vertex.lift_cabin;
    made["floor"] = level.name;
    made["lift_doors"] = Json::array();
    for (const std::size_t door : floor->doors) {
      made["lift_doors"].push_back(world_.model(world_.doors[door].model).name);
    }
    return made;
  }

  // Nothing for one that no robot can follow.
  static std::optional<Json> MakeLane(const SiteLevel& level, const SiteLane& lane) {
    const Vec2& from = level.vertices[lane.edge.start].position;
    const Vec2& to = level.vertices[lane.edge.end].position;
    if ((to - from).norm() < 1e-6) return std::nullopt;
    Json made = Json::object();
    if (lane.is_bidirectional) made["both_ways"] = true;
    if (lane.speed_limit > 0.0) made["speed"] = lane.speed_limit;
    if (lane.orientation == "forward" || lane.orientation == "backward") made["facing"] = lane.orientation;
    if (!lane.mutex.empty()) made["mutex"] = lane.mutex;
    std::map<double, Json> doors;
    for (const SiteDoor& door : level.doors) {
      const Vec2& a = level.vertices[door.edge.start].position;
      const Vec2& b = level.vertices[door.edge.end].position;
      const std::optional<double> at = CrossingAt(from, to, a, b);
      if (!at) continue;
      if (!door.is_operated) return std::nullopt;
      doors.emplace(*at,
                    Json{{"name", DoorName(level, door)}, {"at", *at}, {"clearance", ReachOf(door, (b - a).norm())}});
    }
    for (auto& [at, door] : doors) made["doors"].push_back(std::move(door));
    return made;
  }

  std::optional<Json> Make(std::uint32_t number) const {
    Json vertices = Json::array();
    Json lanes = Json::array();
    bool is_found = false;
    for (std::size_t i = 0; i < site_.levels.size(); ++i) {
      const SiteLevel& level = site_.levels[i];
      std::map<std::size_t, std::size_t> numbers;  // in the graph, by vertex of the level
      std::vector<bool> is_used(level.vertices.size(), false);
      for (const SiteLane& lane : level.lanes) {
        if (lane.graph != number) continue;
        is_used[lane.edge.start] = is_used[lane.edge.end] = is_found = true;
      }
      for (std::size_t k = 0; k < is_used.size(); ++k) {
        if (!is_used[k]) continue;
        numbers.emplace(k, vertices.size());
        vertices.push_back(MakeVertex(level, k, names_[i][k]));
      }
      for (const SiteLane& lane : level.lanes) {
        if (lane.graph != number) continue;
        std::optional<Json> made = MakeLane(level, lane);
        if (!made) continue;
        (*made)["from"] = numbers.at(lane.edge.start);
        (*made)["to"] = numbers.at(lane.edge.end);
        lanes.push_back(std::move(*made));
      }
    }
    if (!is_found) return std::nullopt;
    return Json{{"vertices", std::move(vertices)}, {"lanes", std::move(lanes)}};
  }

  const Site& site_;
  const WorldDescription& world_;
  std::vector<std::vector<std::string>> names_;
  std::map<std::uint32_t, std::optional<Json>> graphs_;
};

}  // namespace

Result<LoadedWorld> AddLanes(LoadedWorld loaded, const LoadOverrides& overrides) {
  if (loaded.site == nullptr) return loaded;
  GraphMaker graphs(*loaded.site, loaded.world);
  for (RobotDescription& robot : loaded.world.robots) {
    if (robot.controller.name != "lanes") continue;
    Json parameters = Json::parse(robot.controller.parameters, nullptr, false);
    if (!parameters.is_object()) continue;
    const auto given = parameters.find("graph");
    const bool is_number = given != parameters.end() && given->is_number_unsigned();
    if (given != parameters.end() && !is_number) continue;
    const std::uint32_t number =
        is_number ? given->get<std::uint32_t>() : graphs.NumberAt(loaded.world.model(robot.root).X_PM);
    const std::optional<Json>& graph = graphs.Get(number);
    if (!graph) {
      return Error{{loaded.site->file},
                   "found no lanes of graph " + std::to_string(number) + " for robot " + Quoted(robot.name) +
                       ", expected some in the building"};
    }
    parameters["graph"] = *graph;
    robot.controller.parameters = parameters.dump();
    if (!overrides.check_controller) continue;
    const Status checked = overrides.check_controller(robot.controller.name, robot.controller.parameters);
    if (!checked.ok()) {
      return Error{{loaded.site->file}, "robot " + Quoted(robot.name) + ": " + checked.error().message};
    }
  }
  return loaded;
}

}  // namespace troupe
