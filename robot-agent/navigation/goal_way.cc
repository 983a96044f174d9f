#include "robot-agent/navigation/goal_way.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory_resource>

#include "common/spatial/body_index.h"
#include "common/spatial/robot_ways.h"
#include "common/spatial/scene.h"
#include "common/spatial/walk_grid.h"
#include "common/spatial/walk_routes.h"
#include "common/spatial/way_search.h"
#include "common/spatial/zone_ways.h"
#include "robot-agent/navigation/barred_lanes.h"
#include "robot-agent/navigation/steering.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kSameGoal = 0.05;       // m: a goal that moves by less, with an estimate that drifts, is the same
constexpr double kHeightChange = 0.05;   // m
constexpr double kJump = 0.5;            // m, in one tick, beside its speed
constexpr double kSeen = 4.0;            // m: bodies so near are searched around
constexpr double kLook = 0.6;            // m, ahead of twice the way to brake
constexpr double kGap = 0.1;             // m, to a body in the way
constexpr double kStanding = 0.05;       // m: with less room it waits
constexpr double kFacing = 0.5;          // rad: it looks along its way once it faces it
constexpr double kRetry = 2.0;           // s, between searches where a body leaves no way
constexpr double kObjectPatience = 0.5;  // s
constexpr double kBodyPatience = 1.0;    // s, before a robot or a person that stands; twice that before one that moves
constexpr double kGiveUp = 30.0;         // s
constexpr int kSearchesOfLargerId = 1;   // that find no way past a robot, until it makes room
constexpr int kSearchesOfSmallerId = 4;
constexpr double kAside = 4.0;         // s, and up to as many more, beside the way
constexpr double kMovedOn = 0.5;       // m: it is not blocked any more
constexpr int kMaxSearches = 60;       // for one goal
constexpr double kDoorAhead = 3.0;     // m, of its way: a door that is nearer is asked for
constexpr double kDoorGap = 0.2;       // m, to what its leaves sweep
constexpr double kZoneAhead = 2.0;     // m, beside twice the way to brake: a release zone that is nearer is looked for
constexpr double kZoneGap = 0.05;      // m, to a release zone
constexpr double kOpen = 0.999;        // of a door
constexpr double kPassed = 0.1;        // m, from a point of the way
constexpr double kPassedByCar = 0.4;   // m
constexpr double kCornerSpeed = 0.25;  // m/s
constexpr double kSharp = 0.35;        // rad, of a corner
constexpr double kAtRest = 1e-3;       // m/s and rad/s

// Of the robot, object or person that the model belongs to.
std::string NameOfBody(const Scene& scene, ModelId model) {
  const WorldDescription& world = scene.world();
  if (const std::optional<RobotId> robot = scene.robot_of(model)) return world.robot(*robot).name;
  if (const std::optional<ObjectId> object = scene.object_of(model)) model = world.objects[object->index()];
  if (const std::optional<PersonId> person = scene.person_of(model)) model = world.person(*person).root;
  return world.model(model).name;
}

// The door of which a body is a leaf.
std::optional<std::size_t> DoorOfLeaf(const Scene& scene, BodyId body) {
  const std::optional<ObjectId> object = scene.object_of(body);
  const std::vector<DoorDescription>& doors = scene.world().doors;
  for (std::size_t i = 0; object && i < doors.size(); ++i) {
    for (const DoorLeaf& leaf : doors[i].leaves) {
      if (leaf.object == *object) return i;
    }
  }
  return std::nullopt;
}

// Of a door that can be asked for: the grid has its leaves as they stand when it is open.
bool IsLeaf(const Scene& scene, BodyId body) {
  const std::optional<std::size_t> door = DoorOfLeaf(scene, body);
  return door && scene.walk_routes().portals().doors[*door];
}

}  // namespace

Status CheckWayToGoal(const Scene& scene, RobotId robot, const Pose& X_WR, const Goal& goal) {
  return CheckWays(scene, robot, X_WR, goal.waypoints);
}

void GoalWay::Reset() {
  *this = GoalWay(own_, drive_);
}

void GoalWay::Begin(const Vec2& goal) {
  Reset();
  goal_ = goal;
  is_due_ = true;
}

Vec2 GoalWay::VelocityOf(const Surroundings& around, BodyId body) {
  if (body.index() < around.world().robots.size()) {
    const RobotState& robot = around.state.robots[body.index()];
    return around.bodies.transform(body).Rotate({robot.twist.vx, robot.twist.vy});
  }
  const std::optional<PersonId> person = around.scene.person_of(body);
  if (!person) return {0.0, 0.0};
  const PersonState& state = around.state.people[person->index()];
  return {state.vx, state.vy};
}

bool GoalWay::Moves(const Surroundings& around, BodyId body) {
  const bool turns =
      body.index() < around.world().robots.size() && std::fabs(around.state.robots[body.index()].twist.wz) > kAtRest;
  return turns || VelocityOf(around, body).norm() > kAtRest;
}

bool GoalWay::MovesAway(const Surroundings& around, BodyId body) const {
  const Vec2 offset = around.bodies.X_WB(body).translation() - around.PoseOf(own_).translation();
  return VelocityOf(around, body).dot(offset) > kAtRest;
}

std::vector<const ConvexPiece*> GoalWay::StandingPieces(const Surroundings& around) const {
  std::pmr::vector<BodyId> standing;
  around.bodies.Query(Rectangle::Around(around.PoseOf(own_).translation(), kSeen), standing);
  std::erase_if(standing, [&](BodyId body) { return Moves(around, body); });
  for (const ModelId model : blockers_) {
    const std::optional<BodyId> body = around.scene.body_of(model);
    if (body && !MovesAway(around, *body)) standing.push_back(*body);
  }
  std::sort(standing.begin(), standing.end());
  standing.erase(std::unique(standing.begin(), standing.end()), standing.end());
  std::vector<const ConvexPiece*> pieces;
  for (const BodyId body : standing) {
    if (body == around.scene.body_of(own_) || around.bodies.owner(body) == own_ || IsLeaf(around.scene, body)) continue;
    for (const ConvexPiece& piece : around.bodies.pieces_in_world(body)) pieces.push_back(&piece);
  }
  return pieces;
}

Status GoalWay::SearchOn(const Surroundings& around, double radius, bool around_bodies) {
  const Pose& X_WR = around.PoseOf(own_);
  grid_radius_ = radius;
  grid_z_ = X_WR.z;
  grid_ = GridOfRobot(around.scene, own_, grid_z_, radius);
  zone_ways_.reset();
  if (std::find(zones_on_.begin(), zones_on_.end(), true) != zones_on_.end()) {
    zone_ways_ = std::make_shared<const ZoneWays>(around.world(), around.state, grid_z_, *grid_);
  }
  std::vector<const ConvexPiece*> pieces;
  if (around_bodies) pieces = StandingPieces(around);
  Result<Way> way = FindWay(*grid_, X_WR.translation(), *goal_, pieces, zone_ways_.get());
  if (!way.ok()) return way.error();
  points_ = std::move(way.value().points);
  reaches_ = way.value().reaches;
  return {};
}

void GoalWay::Search(const Observation& now, const Surroundings& around) {
  is_due_ = false;
  is_aside_ = false;
  aside_until_.reset();
  searched_at_ = now.time;
  points_.clear();
  next_ = 0;
  wait_until_.reset();
  ++searches_;
  const std::array radii = RadiiOfWays(around.scene, own_);
  for (const double radius : radii) {
    if (!SearchOn(around, radius, true).ok()) continue;
    failed_searches_ = 0;
    return;
  }
  // Around static bodies alone: if that fails, too, there is nothing to wait for.
  if (const Status status = SearchOn(around, radii.back(), false); !status.ok()) failure_ = status.error().message;
  on_way_ = FindOnWay(around);
  points_.clear();
  CountBlock(now, around.PoseOf(own_).translation());
  ++failed_searches_;
  if (!failure_) is_aside_ = StepAside(around);
}

std::optional<ModelId> GoalWay::FindOnWay(const Surroundings& around) const {
  Pose X_WR = around.PoseOf(own_);
  for (const Vec2& point : points_) {
    const Vec2 way = point - X_WR.translation();
    const double length = way.norm();
    if (length == 0.0) continue;
    X_WR.heading = Atan2(way.y(), way.x());
    const auto contact = FindContactAhead(around, own_, X_WR, way / length, length);
    if (contact && around.scene.body_of(contact->model)) return contact->model;
    X_WR.x = point.x();
    X_WR.y = point.y();
  }
  return std::nullopt;
}

bool GoalWay::StepAside(const Surroundings& around) {
  const std::optional<RobotId> other = blockers_.empty() ? std::nullopt : around.scene.robot_of(blockers_.back());
  if (!other || failed_searches_ < (*other < own_ ? kSearchesOfLargerId : kSearchesOfSmallerId)) return false;
  const Scene& scene = around.scene;
  const auto of_other = GridOfRobot(scene, own_, grid_z_, scene.body(scene.body_of(*other)).radius);
  const RoomFor room{.own_radius = scene.body(scene.body_of(own_)).radius,
                     .other = around.PoseOf(*other).translation(),
                     .of_other = *of_other};
  Result<Way> way = FindRoom(*grid_, around.PoseOf(own_).translation(), room, StandingPieces(around), zone_ways_.get());
  if (!way.ok()) return false;
  points_ = std::move(way.value().points);
  failed_searches_ = 0;
  return true;
}

// An equal grid of another scene changes nothing: when an agent makes its scene anew is no part of the run.
void GoalWay::FollowGrid(const Surroundings& around) {
  const auto grid = GridOfRobot(around.scene, own_, grid_z_, grid_radius_);
  if (grid == grid_) return;
  for (std::size_t i = next_; i + 1 < points_.size(); ++i) {
    const bool was_clear = grid_->IsClear(points_[i], points_[i + 1]);
    if (was_clear && !grid->IsClear(points_[i], points_[i + 1])) is_due_ = true;
  }
  grid_ = grid;
}

void GoalWay::FollowZones(const Surroundings& around) {
  if (around.world().zones.empty()) return;
  std::vector<bool> on = ZonesOnWays(around.world(), around.state);
  if (on == zones_on_) return;
  is_due_ = true;
  zones_on_ = std::move(on);
}

GoalWay::Leg GoalWay::HeedZones(const Observation& now, const Surroundings& around, const Vec2& along, Leg leg) const {
  if (around.world().zones.empty()) return leg;
  const Pose& X_WR = around.PoseOf(own_);
  const Vec2 here = X_WR.translation();
  leg.most = std::min(leg.most, AllowedSpeed(around, here, along, X_WR.z));
  const double speed = Vec2(now.twist.vx, now.twist.vy).norm();
  const double look = kZoneAhead + speed * speed / std::max(-drive_.acceleration.x.min, 1e-3);
  const double radius = RadiiOfWays(around.scene, own_)[1] + kZoneGap;
  const double room =
      RoomBeforeRelease(around.world(), around.state, here, points_, next_, X_WR.z, radius, 0.5 * grid_->cell(), look);
  if (room >= look) return leg;
  if (room < kStanding) return {here, 0.0, leg.door, WaitOrder()};
  leg.most = std::min(leg.most, BrakingSpeed(drive_, room));
  return leg;
}

GoalWay::Leg GoalWay::WaitFor(const Surroundings& around, std::optional<ModelId> model) const {
  const std::optional<BodyId> body = model ? around.scene.body_of(*model) : std::nullopt;
  WaitOrder wait;
  if (const auto door = body ? DoorOfLeaf(around.scene, *body) : std::nullopt) {
    wait.thing = around.world().doors[*door].model;
  } else if (body) {
    wait.thing = RootOf(around, *model);
  }
  return {around.PoseOf(own_).translation(), 0.0, {}, wait};
}

// An edit may have moved the robot, and a lift changes its height.
void GoalWay::NoteMotion(const Observation& now, const Pose& X_WR) {
  const double most = kJump + 2.0 * now.interval * Vec2(now.twist.vx, now.twist.vy).norm();
  if (last_ && (X_WR.translation() - *last_).norm() > most) is_due_ = true;
  last_ = X_WR.translation();
  if (std::fabs(X_WR.z - grid_z_) > kHeightChange && now.time - searched_at_ >= kRetry) is_due_ = true;
}

// A car cannot turn on the spot, and so passes points farther away.
double GoalWay::PassedDistance() const {
  return drive_.type == DriveType::kCar ? kPassedByCar : kPassed;
}

// Never earlier: a straight line to a later point may lead through a body that the way goes around.
void GoalWay::Advance(const Vec2& here) {
  while (next_ + 1 < points_.size() && (points_[next_] - here).norm() < PassedDistance()) ++next_;
}

// Counts from the place at which it began to be blocked.
void GoalWay::CountBlock(const Observation& now, const Vec2& here) {
  if (blocked_since_ && (here - blocked_at_).norm() < kMovedOn) return;
  blocked_since_ = now.time;
  blocked_at_ = here;
}

void GoalWay::OnBlocked(const Observation& now, const Surroundings& around, ModelId model) {
  std::erase(blockers_, model);
  blockers_.push_back(model);
  if (!wait_until_) {
    const bool is_object = around.scene.object_of(model).has_value();
    const double least = Moves(around, *around.scene.body_of(model)) ? 2.0 * kBodyPatience : kBodyPatience;
    wait_until_ = now.time + (is_object ? kObjectPatience : least * (1.0 + now.Random(8)));
    CountBlock(now, around.PoseOf(own_).translation());
  }
  if (now.time >= *wait_until_) is_due_ = true;
}

// Slow where the way turns behind the next point, so that the robot stays on it.
double GoalWay::CornerSpeed(const Vec2& here) const {
  const Vec2 way = points_[next_] - here;
  if (next_ + 1 == points_.size()) return std::numeric_limits<double>::infinity();
  const Vec2 after = points_[next_ + 1] - points_[next_];
  const double turn = std::fabs(WrapAngle(Atan2(after.y(), after.x()) - Atan2(way.y(), way.x())));
  if (turn < kSharp) return std::numeric_limits<double>::infinity();
  const double braking = BrakingSpeed(drive_, way.norm());
  return std::sqrt(braking * braking + kCornerSpeed * kCornerSpeed);
}

std::optional<std::size_t> GoalWay::ClosedDoorAhead(const Surroundings& around, const Vec2& here) const {
  if (around.state.doors.empty()) return std::nullopt;
  double left = kDoorAhead;
  Vec2 from = here;
  for (std::size_t i = next_; i < points_.size() && left > 0.0; ++i) {
    const Vec2 way = points_[i] - from;
    const double length = way.norm();
    // Half a cell at a time, as WalkGrid::IsClear.
    const int parts = static_cast<int>(2.0 * length / grid_->cell()) + 1;
    for (int part = 1; part <= parts && part * length <= left * parts; ++part) {
      const std::optional<std::size_t> door =
          grid_->DoorOf(grid_->CellOf(from + (static_cast<double>(part) / parts) * way));
      if (door && around.state.doors[*door].opening < kOpen) return door;
    }
    left -= length;
    from = points_[i];
  }
  return std::nullopt;
}

GoalWay::Leg GoalWay::AwaitDoor(const Observation& now, const Surroundings& around, Leg leg) {
  const Vec2 here = around.PoseOf(own_).translation();
  leg.door = ClosedDoorAhead(around, here);
  if (!leg.door) return leg;
  const double radius = RadiiOfWays(around.scene, own_)[1];
  const DoorPortal::Clearance clearance = around.scene.walk_routes().portals().doors[*leg.door]->ClearanceOf(here);
  const double room = clearance.distance - radius - kDoorGap;
  if (room >= kStanding) {
    leg.most = std::min(leg.most, BrakingSpeed(drive_, room));
    return leg;
  }
  CountBlock(now, here);
  wait_until_.reset();
  // Where a leaf could touch it, it makes room.
  const bool is_in_reach = clearance.distance < radius && drive_.type != DriveType::kCar;
  if (is_in_reach) return {here + clearance.away, kCornerSpeed, leg.door};
  return {here, 0.0, leg.door, WaitOrder{around.world().doors[*leg.door].model, {}}};
}

GoalWay::Leg GoalWay::Drive(const Observation& now, const Surroundings& around) {
  const Pose& X_WR = around.PoseOf(own_);
  const Vec2 here = X_WR.translation();
  Advance(here);
  Leg leg{points_[next_], CornerSpeed(here)};
  const Vec2 way = leg.point - here;
  const double length = way.norm();
  if (length < PassedDistance() && is_aside_) {
    if (!aside_until_) aside_until_ = now.time + kAside * (1.0 + now.Random(9));
    is_due_ = now.time >= *aside_until_;
    return WaitFor(around, LastBlocker());
  }
  if (length < PassedDistance() && !reaches_) {  // something stands at the goal
    CountBlock(now, here);
    is_due_ = now.time - searched_at_ >= kRetry;
    return WaitFor(around, LastBlocker());
  }
  leg = AwaitDoor(now, around, leg);
  if (leg.most == 0.0) return leg;
  if (length > 0.0) leg = HeedZones(now, around, way / length, leg);
  if (leg.most == 0.0) return leg;
  const double bearing = WrapAngle(Atan2(way.y(), way.x()) - X_WR.heading);
  if (length == 0.0 || (std::fabs(bearing) > kFacing && drive_.type != DriveType::kCar)) return leg;
  const double speed = Vec2(now.twist.vx, now.twist.vy).norm();
  const double look = kLook + kGap + speed * speed / std::max(-drive_.acceleration.x.min, 1e-3);
  const auto contact = FindContactAhead(around, own_, X_WR, way / length, std::min(length + kGap, look));
  if (!contact || !around.scene.body_of(contact->model)) {
    wait_until_.reset();
    return leg;
  }
  // A body that moves may come as far as the robot goes.
  const bool may_come = Moves(around, *around.scene.body_of(contact->model));
  const double room = std::max((may_come ? 0.5 : 1.0) * contact->room - kGap, 0.0);
  leg.most = std::min(leg.most, BrakingSpeed(drive_, room));
  if (room >= kStanding) return leg;
  OnBlocked(now, around, contact->model);
  Leg wait = WaitFor(around, contact->model);
  wait.door = leg.door;
  return wait;
}

Result<GoalWay::Leg> GoalWay::Update(const Observation& now, const Surroundings& around, const Vec2& goal) {
  if (!goal_ || (goal - *goal_).norm() > kSameGoal) Begin(goal);
  if (failure_) return Failure(*failure_);
  if (grid_) FollowGrid(around);
  FollowZones(around);
  NoteMotion(now, around.PoseOf(own_));
  if (points_.empty() && now.time - searched_at_ >= kRetry) is_due_ = true;
  if (is_due_) Search(now, around);
  if (failure_) return Failure(*failure_);
  const Vec2 here = around.PoseOf(own_).translation();
  if (blocked_since_ && (here - blocked_at_).norm() >= kMovedOn) blocked_since_.reset();
  const Leg leg = points_.empty() ? WaitFor(around, LastBlocker()) : Drive(now, around);
  if ((blocked_since_ && now.time - *blocked_since_ >= kGiveUp) || searches_ > kMaxSearches) {
    const std::optional<ModelId> blocker = LastBlocker();
    failure_ =
        blocker ? fmt::format("{} is in the way", NameOfBody(around.scene, *blocker)) : "something is in the way";
    return Failure(*failure_);
  }
  return leg;
}

}  // namespace troupe
