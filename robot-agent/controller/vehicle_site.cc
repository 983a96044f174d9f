#include "robot-agent/controller/vehicle_site.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/spatial/scene.h"
#include "robot-agent/controller/vehicle_readings.h"
#include "robot-agent/navigation/lane_traffic.h"

namespace troupe {
namespace {

constexpr double kCallLiftFrom = 4.0;     // m, before it waits for a lift
constexpr double kLandingGap = 0.4;       // m, between a vehicle that waits and the doorway of a lift
constexpr double kFloorTolerance = 1e-6;  // m, between the floor of a cabin and that of a level
constexpr double kCabinHeight = 0.5;      // m, of the vehicle above or below the floor of a cabin in which it is

// Where the segment from `from` to `to` crosses the one from `a` to `b`, m along it; nothing: it does not.
std::optional<double> CrossedAt(const Vec2& from, const Vec2& to, const Vec2& a, const Vec2& b) {
  const Vec2 way = to - from;
  const Vec2 line = b - a;
  const double area = Cross(way, line);
  if (area == 0.0) return std::nullopt;
  const Vec2 offset = a - from;
  const double along = Cross(offset, line) / area;
  const double beside = Cross(offset, way) / area;
  if (along < 0.0 || along > 1.0 || beside < 0.0 || beside > 1.0) return std::nullopt;
  return along * way.norm();
}

bool IsLevel(const WorldDescription& world, const std::string& name) {
  return std::any_of(world.levels.begin(), world.levels.end(),
                     [&](const LevelDescription& level) { return level.name == name; });
}

}  // namespace

std::string MapAt(const std::string& parameter, const WorldDescription& world, double z) {
  if (!parameter.empty() && !IsLevel(world, parameter)) return parameter;
  return world.levels.empty() ? "map" : LevelAt(world.levels, z);
}

std::vector<std::string> MapsOf(const std::string& parameter, const WorldDescription& world) {
  if (world.levels.empty() || (!parameter.empty() && !IsLevel(world, parameter))) {
    return {MapAt(parameter, world, 0.0)};
  }
  std::vector<std::string> maps;
  for (const LevelDescription& level : world.levels) maps.push_back(level.name);
  return maps;
}

VehicleSite::VehicleSite(const RobotInfo& info)
    : id_(info.id), lifts_(info.lifts), doors_(info.doors), controls_(info, graph_) {}

void VehicleSite::Begin(const Observation& observation, const Surroundings& around, Command& command) {
  now_ = &observation;
  around_ = &around;
  if (doors_.empty() && lifts_.empty()) return;
  const WorldDescription& world = around.world();
  while (radii_.size() < world.robots.size()) radii_.push_back(RadiusOf(world, RobotId(radii_.size())));
  radius_ = radii_[id_.index()];
  others_ = SeeOthers(world, around.state, id_, radii_);
  if (!doorways_) FindDoorways();
  controls_.SetGraph(graph_);
  controls_.Begin(observation, command);
}

// Those of lifts belong to these.
void VehicleSite::FindDoorways() {
  doorways_.emplace();
  const WorldDescription& world = around_->world();
  std::vector<bool> is_of_lift(world.doors.size(), false);
  for (const LiftDescription& lift : world.lifts) {
    for (const std::size_t door : lift.cabin_doors) is_of_lift[door] = true;
    for (const LiftFloor& floor : lift.floors) {
      for (const std::size_t door : floor.doors) is_of_lift[door] = true;
    }
  }
  for (std::size_t i = 0; i < world.doors.size(); ++i) {
    if (is_of_lift[i]) continue;
    // Two leaves do not quite meet: from the one end of them all to the other.
    std::vector<Vec2> ends;
    for (const DoorLeaf& leaf : world.doors[i].leaves) {
      const Rectangle box = BoxOf(*around_, around_->scene.body_of(leaf.object));
      if (box.empty()) continue;
      const Transform2 X_WH(leaf.X_WH);
      const double middle = 0.5 * (box.min_y + box.max_y);
      ends.push_back(X_WH * Vec2(box.min_x, middle));
      ends.push_back(X_WH * Vec2(box.max_x, middle));
    }
    Doorway doorway;
    doorway.door = i;
    for (const Vec2& a : ends) {
      for (const Vec2& b : ends) {
        if ((b - a).norm() > (doorway.right - doorway.left).norm())
          std::tie(doorway.left, doorway.right) = std::tie(a, b);
      }
    }
    doorways_->push_back(doorway);
  }
}

std::vector<LaneDoor> VehicleSite::DoorsOn(const Vec2& from, const Vec2& to, double z) const {
  std::vector<LaneDoor> doors;
  for (const Doorway& doorway : *doorways_) {
    if (std::fabs(doors_[doorway.door].z - z) >= kLevelGap) continue;
    const std::optional<double> at = CrossedAt(from, to, doorway.left, doorway.right);
    if (at) doors.push_back({static_cast<std::uint32_t>(doorway.door), *at});
  }
  std::sort(doors.begin(), doors.end(), [](const LaneDoor& a, const LaneDoor& b) { return a.at < b.at; });
  return doors;
}

// Cabins end at their doors, and are not larger in other directions.
std::optional<std::uint32_t> VehicleSite::LiftAround(const Vec2& place) const {
  for (std::size_t i = 0; i < lifts_.size(); ++i) {
    double farthest = 0.0;
    bool is_within = true;
    for (const std::vector<std::size_t>& of_floor : lifts_[i].doors) {
      for (const std::size_t door : of_floor) {
        const Vec2 outwards = doors_[door].middle - lifts_[i].middle;
        const double distance = outwards.norm();
        farthest = std::max(farthest, distance);
        is_within = is_within && (place - lifts_[i].middle).dot(outwards) < distance * distance;
      }
    }
    if (is_within && (place - lifts_[i].middle).norm() < farthest) return static_cast<std::uint32_t>(i);
  }
  return std::nullopt;
}

double VehicleSite::ZOf(const std::string& map, double z) const {
  for (const LevelDescription& level : around_->world().levels) {
    if (level.name == map) return level.z;
  }
  return z;
}

void VehicleSite::MakeGraph(const VehicleWay& way) {
  graph_.vertices.clear();
  graph_.lanes.clear();
  legs_.clear();
  double z = now_->pose_estimate.z;
  for (std::size_t i = 0; i < way.points.size(); ++i) {
    const VehicleWay::Point& point = way.points[i];
    const double before = z;
    if (point.is_node) z = ZOf(point.map, z);
    LaneVertex vertex;
    vertex.position = point.place;
    vertex.z = z;
    if (i == 0 || point.is_node) vertex.lift = LiftAround(point.place);
    if (vertex.lift) {
      // The floor of that height; its exact height is that at which the cabin stops.
      const std::vector<LiftFloor>& floors = around_->world().lifts[*vertex.lift].floors;
      for (std::size_t floor = 0; floor < floors.size(); ++floor) {
        const double best = std::fabs(floors[vertex.floor].z - z);
        if (std::fabs(floors[floor].z - z) < best) vertex.floor = static_cast<std::uint32_t>(floor);
      }
      if (point.is_node) vertex.z = floors[vertex.floor].z;
    }
    graph_.vertices.push_back(vertex);
    if (i == 0) continue;
    Leg leg{i - 1, i, {}};
    if (std::fabs(z - before) < kLevelGap) {
      Lane lane;
      lane.start = static_cast<std::uint32_t>(i - 1);
      lane.end = static_cast<std::uint32_t>(i);
      lane.doors = DoorsOn(way.points[i - 1].place, point.place, z);
      leg.lane = graph_.lanes.size();
      graph_.lanes.push_back(std::move(lane));
    }
    legs_.push_back(leg);
  }
}

// Where the vehicle is, the cabin is, too.
bool VehicleSite::IsInCabin() const {
  const LaneVertex& here = graph_.vertices.front();
  return here.lift && std::fabs(now_->lifts[*here.lift].z - now_->pose_estimate.z) < kCabinHeight;
}

double VehicleSite::WayToLift(std::size_t vertex) const {
  const LaneVertex& node = graph_.vertices[vertex];
  std::vector<Vec2> path;
  for (std::size_t i = 0; i <= vertex; ++i) path.push_back(graph_.vertices[i].position);
  double way = 0.0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) way += (path[i + 1] - path[i]).norm();
  for (const std::size_t door : lifts_[*node.lift].doors[node.floor]) {
    const double reach = radius_ + kLandingGap;
    if (const std::optional<double> entry = WayIntoDisc(path, doors_[door].middle, reach)) way = std::min(way, *entry);
  }
  return way;
}

void VehicleSite::Limited(Limit& limit, double room, ModelId thing, bool is_stuck) const {
  if (limit.room && *limit.room <= room) return;
  limit.room = room;
  limit.thing = thing;
  limit.is_stuck = is_stuck;
}

void VehicleSite::LimitByLift(Limit& limit, std::vector<std::size_t>& needed) {
  const WorldDescription& world = around_->world();
  const Vec2 here = graph_.vertices.front().position;
  const bool is_inside = IsInCabin();
  if (is_inside) needed.push_back(0);
  // The first node, to which the cabin may have to bring it.
  std::size_t first = 1;
  while (first + 1 < graph_.vertices.size() && !graph_.vertices[first].lift && legs_[first - 1].lane) ++first;
  const LaneVertex& next = graph_.vertices[first];
  const bool is_ride = is_inside && next.lift == graph_.vertices.front().lift &&
                       std::fabs(now_->lifts[*next.lift].z - next.z) > kFloorTolerance;
  if (is_ride) {
    needed.push_back(first);
    controls_.CallLift(first);
    limit.rides = true;
    return Limited(limit, 0.0, world.lifts[*next.lift].model, false);
  }
  if (!legs_.front().lane && !(is_inside && next.lift == graph_.vertices.front().lift)) {
    limit.has_no_lift = true;
    limit.room = 0.0;
    return;
  }
  if (is_inside && next.lift != graph_.vertices.front().lift) {  // out
    controls_.CallLift(0);
    const bool is_free = controls_.PlaceAt(0, here, radius_) != SiteControls::AtCabin::kInside;
    if (!is_free && !controls_.StandsOpenAt(0)) {
      Limited(limit, 0.0, world.lifts[*graph_.vertices.front().lift].model, false);
    }
    return;
  }
  if (!next.lift) return;
  if (is_inside) {  // to its place in the cabin
    controls_.CallLift(first);
    return;
  }
  // In.
  if (controls_.PlaceAt(first, here, radius_) != SiteControls::AtCabin::kOutside && WayToLift(first) == 0.0) {
    needed.push_back(first);
    controls_.CallLift(first);
    if (!controls_.StandsOpenAt(first)) Limited(limit, 0.0, world.lifts[*next.lift].model, false);
    return;
  }
  const double way = WayToLift(first);
  bool may_enter = false;
  if (way <= kCallLiftFrom) {
    needed.push_back(first);
    may_enter =
        controls_.AwaitLift(first, others_) && controls_.StandsOpenAt(first) && !IsTaken(next, others_, radius_);
  }
  if (!may_enter) Limited(limit, way, world.lifts[*next.lift].model, false);
}

void VehicleSite::LimitByDoors(Limit& limit) {
  for (const SiteControls::DoorAhead& ahead :
       controls_.DoorsAhead(legs_, now_->pose_estimate.translation(), 0.0, radius_)) {
    if (controls_.OpenDoor(*ahead.door)) continue;
    const ModelId model = around_->world().doors[ahead.door->door].model;
    Limited(limit, ahead.way_before, model, controls_.IsStuck(*ahead.door));
  }
}

void VehicleSite::End(const std::vector<std::size_t>& needed) {
  controls_.CloseBehind(legs_, now_->pose_estimate.translation(), radius_, others_);
  controls_.EndSessions(needed);
}

VehicleSite::Limit VehicleSite::Follow(const VehicleWay& way) {
  Limit limit;
  if ((doors_.empty() && lifts_.empty()) || way.points.size() < 2) return limit;
  MakeGraph(way);
  std::vector<std::size_t> needed;
  LimitByLift(limit, needed);
  if (!limit.rides) LimitByDoors(limit);
  End(needed);
  return limit;
}

void VehicleSite::Rest(bool has_way) {
  if (doors_.empty() && lifts_.empty()) return;
  MakeGraph({{{now_->pose_estimate.translation(), false, {}}}});
  std::vector<std::size_t> needed;
  if (has_way && IsInCabin()) {
    needed.push_back(0);
    controls_.CallLift(0);
  }
  End(needed);
}

}  // namespace troupe
