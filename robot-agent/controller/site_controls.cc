#include "robot-agent/controller/site_controls.h"

#include <algorithm>
#include <cmath>

namespace troupe {
namespace {

constexpr double kOpen = 0.999;      // of a door
constexpr double kPatience = 5.0;    // s, with a blocked landing door
constexpr double kCallAhead = 3.0;   // m, before it waits for a door
constexpr double kMaxSweep = 3.0;    // m, from a doorway to where a robot waits
constexpr double kDoorMargin = 0.2;  // m, between a robot and the way of a leaf
constexpr double kLeafBeside = 0.1;  // m, that a sliding leaf reaches out of its doorway

}  // namespace

// m along the path to the first point within the disc; nothing: the path stays outside.
std::optional<double> WayIntoDisc(std::span<const Vec2> path, const Vec2& center, double radius) {
  double before = 0.0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Vec2 way = path[i + 1] - path[i];
    const double length = way.norm();
    const Vec2 offset = center - path[i];
    if (offset.norm() < radius) return before;
    if (length == 0.0) continue;
    const double along = offset.dot(way) / length;
    const double half_squared = radius * radius - (offset.squaredNorm() - along * along);
    if (half_squared > 0.0) {
      const double at = along - std::sqrt(half_squared);
      if (at >= 0.0 && at < length) return before + at;
    }
    before += length;
  }
  return std::nullopt;
}

SiteControls::SiteControls(const RobotInfo& info, const LaneGraph& graph)
    : id_(info.id), graph_(&graph), doors_(info.doors), lifts_(info.lifts), blocked_since_(lifts_.size()) {}

void SiteControls::Begin(const Observation& observation, Command& command) {
  now_ = &observation;
  command_ = &command;
  openings_before_.swap(openings_);
  openings_.clear();
  for (const DoorState& door : observation.doors) openings_.push_back(door.opening);
}

// The order is repeated in each tick: an order for the present floor changes nothing.
bool SiteControls::CallLift(std::size_t vertex) {
  const std::optional<std::uint32_t> lift = LiftOf(vertex);
  if (!lift) return true;
  if (IsOfAnother(vertex)) return false;
  command_->orders.push_back(LiftOrder{*lift, graph_->vertices[vertex].floor});
  return now_->lifts[*lift].session.has_value();
}

bool SiteControls::IsOfAnother(std::size_t vertex) const {
  const std::optional<RobotId>& session = now_->lifts[*LiftOf(vertex)].session;
  return session && *session != id_;
}

// At whatever height the cabin is.
bool SiteControls::HasInCabin(std::size_t vertex, const SeenRobot& robot) const {
  const std::uint32_t number = *LiftOf(vertex);
  const LiftInfo& lift = lifts_[number];
  if (std::fabs(robot.z - now_->lifts[number].z) >= kLevelGap) return false;
  double farthest = 0.0;  // m, of a door from the middle
  for (const std::size_t door : lift.doors[graph_->vertices[vertex].floor]) {
    farthest = std::max(farthest, (doors_[door].middle - lift.middle).norm());
  }
  return (robot.position - lift.middle).norm() < farthest && PlaceAt(vertex, robot.position, 0.0) != AtCabin::kOutside;
}

bool SiteControls::AwaitLift(std::size_t vertex, const std::vector<SeenRobot>& others) {
  const std::optional<std::uint32_t> lift = LiftOf(vertex);
  if (!lift) return true;
  const std::optional<RobotId>& session = now_->lifts[*lift].session;
  // A robot in the cabin may have lost its session to a user: it calls the lift again once this one leaves it free.
  const bool is_used = std::any_of(others.begin(), others.end(), [&](const SeenRobot& other) {
    return session != other.id && HasInCabin(vertex, other);
  });
  if (is_used) {
    if (session == id_) command_->orders.push_back(LiftOrder{*lift, 0, true});
    return false;
  }
  const std::vector<std::size_t>& doors = lifts_[*lift].doors[graph_->vertices[vertex].floor];
  const bool is_blocked = StandsAt(*lift, vertex) && std::any_of(doors.begin(), doors.end(), [&](std::size_t door) {
                            return now_->doors[door].blocked;
                          });
  std::optional<double>& since = blocked_since_[*lift];
  since = is_blocked ? std::optional(since.value_or(now_->time)) : std::nullopt;
  // A landing door that is blocked for a moment is no reason to give the lift away.
  if (!since || now_->time - *since < kPatience) return CallLift(vertex);
  if (session == id_) command_->orders.push_back(LiftOrder{*lift, 0, true});
  return false;
}

bool SiteControls::StandsAt(std::uint32_t lift, std::size_t vertex) const {
  const LaneVertex& place = graph_->vertices[vertex];
  const LiftState& state = now_->lifts[lift];
  return state.floor == place.floor && std::fabs(state.z - place.z) <= 1e-6;
}

// All doors at the floor: a robot drives in only when none of them moves.
bool SiteControls::StandsOpenAt(std::size_t vertex) const {
  const std::optional<std::uint32_t> lift = LiftOf(vertex);
  if (!lift) return true;
  if (!StandsAt(*lift, vertex)) return false;
  const std::vector<std::size_t>& doors = lifts_[*lift].doors[graph_->vertices[vertex].floor];
  return std::all_of(doors.begin(), doors.end(), [&](std::size_t door) { return now_->doors[door].opening >= kOpen; });
}

// By the planes of the doors, as cabins are open nowhere else.
SiteControls::AtCabin SiteControls::PlaceAt(std::size_t vertex, const Vec2& position, double radius) const {
  constexpr double kLeaf = 0.05;  // m, half the thickness of a leaf and more
  const LiftInfo& lift = lifts_[*LiftOf(vertex)];
  AtCabin place = AtCabin::kInside;
  for (const std::size_t door : lift.doors[graph_->vertices[vertex].floor]) {
    const Vec2 outwards = doors_[door].middle - lift.middle;
    const double distance = outwards.norm();
    if (distance == 0.0) continue;
    const double beyond = (position - lift.middle).dot(outwards) / distance - distance;  // m
    // A closed door has the robot on one side of it.
    const double reach = now_->doors[door].opening == 0.0 ? 0.0 : radius + kLeaf;
    if (beyond >= reach) return AtCabin::kOutside;
    if (beyond > -reach) place = AtCabin::kInDoorway;
  }
  return place;
}

// A session that is not needed any more blocks other robots.
void SiteControls::EndSessions(const std::vector<std::size_t>& needed) {
  for (std::size_t i = 0; i < now_->lifts.size(); ++i) {
    if (now_->lifts[i].session != id_) continue;
    if (std::any_of(needed.begin(), needed.end(), [&](std::size_t vertex) { return LiftOf(vertex) == i; })) continue;
    std::erase_if(command_->orders, [&](const Order& order) {
      const auto* const call = std::get_if<LiftOrder>(&order);
      return call != nullptr && call->lift == i;
    });
    command_->orders.push_back(LiftOrder{i, 0, true});
  }
}

std::vector<SiteControls::DoorAhead> SiteControls::DoorsAhead(const std::vector<Leg>& legs, const Vec2& position,
                                                              double at, double radius) const {
  struct Doorway {
    const LaneDoor* door = nullptr;
    double way = 0.0;  // m
  };
  std::vector<Vec2> path{position};
  std::vector<Doorway> doorways;
  double way = -at;  // m, to the start of the leg
  for (const Leg& leg : legs) {
    if (way > kCallAhead + kMaxSweep || (!leg.lane && leg.from != leg.to)) break;
    const Vec2& end = graph_->vertices[leg.to].position;
    double length = (end - path.back()).norm();
    if (leg.lane) {
      const Lane& lane = graph_->lanes[*leg.lane];
      length = graph_->Way(leg.from, leg.to).norm();
      for (const LaneDoor& door : lane.doors) {
        const double to_door = way + (leg.from == lane.start ? door.at : length - door.at);
        if (to_door >= 0.0) doorways.push_back({&door, to_door});
      }
    }
    way += length;
    path.push_back(end);
  }
  std::vector<DoorAhead> doors;
  for (const Doorway& doorway : doorways) {
    const double way_before = WayBefore(*doorway.door, doorway.way, path, radius);
    if (way_before <= kCallAhead) doors.push_back({doorway.door, way_before});
  }
  return doors;
}

// `way`: m along the path to the doorway.
double SiteControls::WayBefore(const LaneDoor& door, double way, std::span<const Vec2> path, double radius) const {
  way = std::max(way - kLeafBeside - radius - kDoorMargin, 0.0);
  for (const LeafSweep& sweep : doors_[door.door].sweeps) {
    const std::optional<double> entry = WayIntoDisc(path, sweep.hinge, sweep.radius + radius + kDoorMargin);
    if (entry) way = std::min(way, *entry);
  }
  return way;
}

bool SiteControls::IsClear(const Vec2& from, const Vec2& to, double z, double radius) const {
  const Vec2 path[] = {from, to};
  return std::none_of(doors_.begin(), doors_.end(), [&](const DoorInfo& door) {
    return std::fabs(door.z - z) < kLevelGap &&
           std::any_of(door.sweeps.begin(), door.sweeps.end(), [&](const LeafSweep& sweep) {
             return WayIntoDisc(path, sweep.hinge, sweep.radius + radius).has_value();
           });
  });
}

// True: it is open.
bool SiteControls::OpenDoor(const LaneDoor& door) {
  command_->orders.push_back(DoorOrder{door.door, 1.0});
  Note(door.door);
  return now_->doors[door.door].opening >= kOpen;
}

bool SiteControls::IsStuck(const LaneDoor& door) const {
  return door.door < openings_before_.size() && openings_before_[door.door] == openings_[door.door];
}

void SiteControls::Note(std::uint32_t door) {
  const bool is_known =
      std::any_of(passing_.begin(), passing_.end(), [&](const Passing& passing) { return passing.door == door; });
  if (!is_known) passing_.push_back({door});
}

void SiteControls::Note(const Lane& lane) {
  for (const LaneDoor& door : lane.doors) Note(door.door);
}

bool SiteControls::IsOnWay(std::uint32_t door, const std::vector<Leg>& legs) const {
  return std::any_of(legs.begin(), legs.end(), [&](const Leg& leg) {
    if (!leg.lane) return false;
    const std::vector<LaneDoor>& doors = graph_->lanes[*leg.lane].doors;
    return std::any_of(doors.begin(), doors.end(), [&](const LaneDoor& each) { return each.door == door; });
  });
}

bool SiteControls::IsNearLeaves(const DoorInfo& door, const Vec2& position, double radius) {
  if ((position - door.middle).norm() < kLeafBeside + radius + kDoorMargin) return true;
  return std::any_of(door.sweeps.begin(), door.sweeps.end(), [&](const LeafSweep& sweep) {
    return (position - sweep.hinge).norm() < sweep.radius + radius + kDoorMargin;
  });
}

// Only doors that this robot has opened, once it is through and no robot is near the leaves.
void SiteControls::CloseBehind(const std::vector<Leg>& legs, const Vec2& position, double radius,
                               const std::vector<SeenRobot>& others) {
  for (Passing& passing : passing_) {
    const DoorInfo& door = doors_[passing.door];
    if ((position - door.middle).norm() < radius + kDoorMargin) passing.is_through = true;
    const bool is_on_way = IsOnWay(passing.door, legs);
    if ((is_on_way && !passing.is_through) || IsNearLeaves(door, position, radius)) continue;
    const bool is_used = std::any_of(others.begin(), others.end(), [&](const SeenRobot& other) {
      return std::fabs(other.z - door.z) < kLevelGap && IsNearLeaves(door, other.position, other.radius);
    });
    if (is_used) continue;  // it stays open until the other robot is gone, too
    // A request of this tick was for a way that the robot has just left.
    if (!is_on_way) {
      std::erase_if(command_->orders, [&](const Order& order) {
        const auto* const opened = std::get_if<DoorOrder>(&order);
        return opened != nullptr && opened->door == passing.door;
      });
    }
    command_->orders.push_back(DoorOrder{passing.door, 0.0});
    passing.is_done = true;
  }
  std::erase_if(passing_, [](const Passing& passing) { return passing.is_done; });
}

}  // namespace troupe
