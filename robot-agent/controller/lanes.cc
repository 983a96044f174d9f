// lanes: drives along the lanes of a site to places, through doors and with lifts, and gives way to other robots.
//
// A route is a list of legs from vertex to vertex (lane_route.h). The robot drives along the front leg, and enters it
// only when all that it needs is there: lifts, then doors, then mutex groups, in this order, for the reasons at
// MayEnter. Deadlocks that remain are resolved by giving way (giving_way.h). Before all that is no robot it stops too
// (lane_obstacles.h), and then goes round it or says that it waits.
//
// The parts are separate: LaneTasks says where to go, FastestRoute how, SiteControls operates doors and lifts,
// MutexGroup and MutexTurn decide which robot enters a group, GivingWay finds the way out of a block. All of them read
// the frame of the tick alone; no robot sends a message to another.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/model/lane_rules.h"
#include "common/spatial/scene.h"
#include "robot-agent/controller/built_in.h"
#include "robot-agent/controller/giving_way.h"
#include "robot-agent/controller/lane_settings.h"
#include "robot-agent/controller/lane_tasks.h"
#include "robot-agent/controller/site_controls.h"
#include "robot-agent/navigation/barred_lanes.h"
#include "robot-agent/navigation/lane_traffic.h"
#include "robot-agent/navigation/planned_way.h"
#include "robot-agent/navigation/steering.h"
#include "robot-agent/navigation/surroundings.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kLookAhead = 1.0;       // m along a lane: the point that it steers to
constexpr double kTurnFirst = 0.35;      // rad: it turns on the spot to a point farther to the side
constexpr double kStraightOn = 0.955;    // cosine of the turn between two lanes that it passes without braking
constexpr double kCreep = 0.02;          // m/s: it rather stands
constexpr double kDockTolerance = 0.03;  // m
constexpr double kPersonGap = 0.05;      // m: people step aside for a robot that comes near
constexpr double kSeeAhead = 4.0;        // m
constexpr double kTurnAhead = 0.3;       // rad: of a turn on the spot it looks so far ahead
constexpr double kNoWaySeconds = 1.0;    // at rest, until it leaves a destination out to which no lanes lead
constexpr double kAtStart = 0.5;         // m along a lane: it has hardly left
// s at rest before a person, who perhaps waits for it: until it moves anywhere, so that the person can pass.
constexpr double kMoverPatience = 3.0;
constexpr double kTouchingSeconds = 1.0;  // with a contact, until it asks for another way

constexpr auto kAnyVertex = [](std::size_t) { return true; };

class LanesController final : public Controller, public RobotWatcher {
 public:
  LanesController(const RobotInfo& info, const LaneSettings& settings, const LaneGraph& graph)
      : id_(info.id),
        settings_(settings),
        graph_(&graph),
        drive_(info.robot->drive),
        steer_{SpeedOf(drive_, settings), settings.turn_rate},
        recovery_(drive_, steer_),
        tasks_(settings, graph, steer_.speed, can_turn()),
        controls_(info, graph),
        giving_way_(id_, graph, info.lane_graphs, steer_.speed) {
    if (settings.planned) plan_.emplace(id_, graph, info.lane_graphs);
    first_lane_ = FirstLaneOf(info.lane_graphs, graph);
    for (const LaneVertex& vertex : graph_->vertices) AddGroup(vertex.mutex);
    for (const Lane& lane : graph_->lanes) AddGroup(lane.mutex);
  }

  bool AcceptsGoals() const override { return true; }

  void WatchRobots(const Surroundings& around) override {
    around_.emplace(around);
    const WorldDescription& world = around.world();
    while (radii_.size() < world.robots.size()) radii_.push_back(RadiusOf(world, RobotId(radii_.size())));
    radius_ = radii_[id_.index()];
    half_width_ = std::min(radius_, 0.5 * world.model(world.robot(id_).root).size_y);
    others_ = SeeOthers(world, around.state, id_, radii_);
    if (plan_) plan_->Read(around.state);
    tasks_.Watch(world, around.state, id_, others_, radius_);
    has_new_bars_ = barred_.Read(around, id_, *graph_);
  }

  Command Update(const Observation& observation) override {
    now_ = &observation;
    command_ = {};
    is_blocked_ = false;
    wait_.reset();
    controls_.Begin(observation, command_);
    if (!has_started_) Start();
    const double patience = observation.stalled ? Recovery::kPatience
                            : waits_for_mover_  ? kMoverPatience
                                                : Recovery::kNever;
    waits_for_mover_ = false;
    if (std::optional<Command> recovery = recovery_.Update(observation, patience)) {
      tasks_.AddOrders(observation, *recovery);
      return *std::move(recovery);
    }
    if (std::exchange(has_new_bars_, false)) HeedBars();
    tasks_.Update(observation, at_, barred_.lanes());
    SetTarget();
    if (plan_) {
      TakePart();
      FollowPlan();
    } else if (legs_.empty() && target_ && *target_ != at_ && !is_unreachable_) {
      PlanTo(*target_);
    }
    if (legs_.empty()) {
      Rest();
    } else {
      Follow();
    }
    if (!is_blocked_) {
      giving_way_.OnFree(now_->time);
      start_blocked_since_.reset();
      has_said_start_ = false;
      obstructed_since_.reset();
      asks_for_way_ = false;
    }
    if (settings_.close_doors) controls_.CloseBehind(legs_, position(), radius_, others_);
    controls_.EndSessions(NeededVertices());
    if (plan_) AddTrafficOrder();
    tasks_.AddOrders(observation, command_);
    const bool stands = command_.twist.IsZero() && command_.speed == 0.0;
    if (wait_ && stands) command_.orders.emplace_back(*wait_);
    return std::move(command_);
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<LanesController>(*this); }

 private:
  static double SpeedOf(const DriveDescription& drive, const LaneSettings& settings) {
    if (settings.speed > 0.0) return settings.speed;
    return std::clamp(drive.velocity.x.max, 0.01, LaneSettings::kMaxSpeed);
  }

  // It cannot go on along the first leg because of a thing, if it knows one.
  void NoteWait(std::optional<ModelId> thing) {
    const std::optional<std::size_t> lane = legs_.empty() ? std::nullopt : legs_.front().lane;
    wait_ = {thing, lane ? std::optional(static_cast<std::uint32_t>(first_lane_ + *lane)) : std::nullopt};
  }
  void NoteWaitForLift(std::size_t vertex_of_lift) {
    const std::optional<std::uint32_t> lift = vertex(vertex_of_lift).lift;
    NoteWait(lift && around_ ? std::optional(around_->world().lifts[*lift].model) : std::nullopt);
  }
  void NoteWaitForDoor(const LaneDoor& door) {
    NoteWait(around_ ? std::optional(around_->world().doors[door.door].model) : std::nullopt);
  }
  void NoteWaitForRobot(RobotId robot) {
    NoteWait(around_ ? std::optional(around_->world().robot(robot).root) : std::nullopt);
  }

  void AddGroup(const std::string& name) {
    if (!name.empty() && !groups_.contains(name)) groups_.emplace(name, MutexGroup(*graph_, name));
  }

  Vec2 position() const { return now_->pose_estimate.translation(); }
  bool can_turn() const { return drive_.type != DriveType::kCar; }
  const LaneVertex& vertex(std::size_t number) const { return graph_->vertices[number]; }
  const Lane& lane(std::size_t number) const { return graph_->lanes[number]; }
  Vec2 WayOf(const Leg& leg) const { return graph_->Way(leg.from, leg.to); }
  LanePlace place() const { return {*now_, at_, target_, others_, radius_, half_width_}; }

  // The way to a vertex of the level is the first leg: to the nearest one whose way is clear, if there is one.
  void Start() {
    has_started_ = true;
    if (plan_ && plan_->takes_part()) return GoStraightTo(plan_->at());
    const std::size_t nearest = FindNearestVertex(*graph_, position(), now_->pose_estimate.z, kOnOneLevel)->vertex;
    GoStraightTo(IsClearTo(nearest) ? nearest : FindClearVertex(kAnyVertex).value_or(nearest));
  }

  // A leg without a lane.
  void GoStraightTo(std::size_t vertex) {
    at_ = vertex;
    legs_ = {{at_, at_, {}}};
    is_on_leg_ = true;
  }

  // The straight way keeps clear of the leaves of doors, also open ones, and nothing is on it.
  bool IsClearTo(std::size_t to) const {
    const Vec2 way = vertex(to).position - position();
    const double length = way.norm();
    if (!controls_.IsClear(position(), vertex(to).position, now_->pose_estimate.z, radius_)) return false;
    if (length == 0.0) return true;
    const std::optional<LaneObstacle> obstacle =
        FindObstacle(position(), way / length, length - settings_.tolerance, false);
    return !obstacle || obstacle->walks;
  }

  // The nearest vertex with a clear straight way to it, of those that `may_be` allows.
  template <typename MayBe>
  std::optional<std::size_t> FindClearVertex(const MayBe& may_be) const {
    std::optional<std::size_t> clear;
    double least = 0.0;
    for (std::size_t i = 0; i < graph_->vertices.size(); ++i) {
      const double distance = (vertex(i).position - position()).norm();
      if (std::fabs(vertex(i).z - now_->pose_estimate.z) >= kLevelGap || (clear && distance >= least)) continue;
      if (!may_be(i) || !IsClearTo(i)) continue;
      least = distance;
      clear = i;
    }
    return clear;
  }

  void SetTarget() {
    const std::optional<std::size_t> target = tasks_.target();
    if (target == target_) return;
    target_ = target;
    is_unreachable_ = waits_for_lanes_ = false;
    rest_since_.reset();
    if (plan_) {
      CheckTarget();
      return;
    }
    // A leg that it is on is finished first.
    if (!legs_.empty()) legs_.resize(is_on_leg_ ? 1 : 0);
  }

  // Other lanes are barred than before: it finishes the lane that it is on, and looks for its way again.
  void HeedBars() {
    const std::vector<std::size_t>& barred = barred_.lanes();
    giving_way_.Bar(barred);
    is_unreachable_ = waits_for_lanes_ = false;
    if (plan_) return;
    const std::size_t kept = is_on_leg_ ? 1 : 0;
    const auto is_barred = [&](const Leg& leg) {
      return leg.lane && std::binary_search(barred.begin(), barred.end(), *leg.lane);
    };
    if (legs_.size() > kept && std::any_of(legs_.begin() + static_cast<std::ptrdiff_t>(kept), legs_.end(), is_barred)) {
      legs_.resize(kept);
    }
  }

  void PlanTo(std::size_t target) {
    std::optional<LaneRoute> route = giving_way_.FindRoute(at_, target, now_->time);
    is_unreachable_ = !route;
    waits_for_lanes_ = !route && !barred_.lanes().empty() && FastestRoute(*graph_, at_, target, steer_.speed);
    if (!route) {
      const std::string ends = fmt::format("from {} to {}", NameOf(*graph_, at_), NameOf(*graph_, target));
      command_.report = waits_for_lanes_ ? "all ways " + ends + " are closed: waits" : "no lanes lead " + ends;
      return;
    }
    legs_ = std::move(route->legs);
    is_on_leg_ = false;
  }

  // In the planned traffic: whether lanes lead to a target at all.
  void CheckTarget() {
    if (!target_ || *target_ == at_ || FastestRoute(*graph_, at_, *target_, steer_.speed)) return;
    is_unreachable_ = true;
    command_.report = fmt::format("no lanes lead from {} to {}", NameOf(*graph_, at_), NameOf(*graph_, *target_));
  }

  // Until it takes part, other robots may be at the vertex at which it would begin. One that has taken part, and does
  // no more, is somewhere else: it has been moved, or was lost for a while.
  void TakePart() {
    if (plan_->takes_part()) {
      has_said_taken_ = false;
      return;
    }
    if (std::exchange(has_arrived_, false)) Start();
    if (!plan_->IsTaken(at_)) return;
    const std::optional<std::size_t> other = FindClearVertex([this](std::size_t i) { return !plan_->IsTaken(i); });
    if (other) {
      GoStraightTo(*other);
    } else if (!std::exchange(has_said_taken_, true)) {
      command_.report =
          fmt::format("{} is taken, and there is no free way to another vertex: waits", NameOf(*graph_, at_));
    }
  }

  // The granted moves are the legs, once it is at the vertex at which it begins to take part.
  void FollowPlan() {
    if (!has_arrived_) return;
    std::vector<Leg> legs = plan_->Legs();
    const bool goes_on = !legs.empty() && !legs_.empty() && legs.front() == legs_.front();
    legs_ = std::move(legs);
    // It turns back on its way: it is on the leg to where it began.
    if (!goes_on) is_on_leg_ = !legs_.empty() && legs_.front().from == legs_.front().to;
  }

  void AddTrafficOrder() {
    const bool is_on_lane = !legs_.empty() && is_on_leg_ && legs_.front().lane;
    touching_ticks_ = now_->stalled && is_on_lane ? touching_ticks_ + 1 : 0;
    const double touching = static_cast<double>(touching_ticks_) * now_->interval;
    TrafficOrder order = plan_->OrderFor(at_, is_unreachable_ ? std::nullopt : target_);
    order.holds = !has_arrived_ || target_ == at_;
    order.is_blocked = touching > kTouchingSeconds || asks_for_way_;
    if (is_on_lane) {
      const Vec2 way = WayOf(legs_.front());
      order.driven = std::max(0.0, (position() - vertex(legs_.front().from).position).dot(way) / way.norm());
    }
    command_.orders.emplace_back(order);
  }

  // At a vertex without a way to drive.
  void Rest() {
    if (!rest_since_) rest_since_ = now_->time;
    const double rested = now_->time - *rest_since_;
    const bool was_aside = tasks_.is_aside();
    if (target_ && *target_ != at_) {
      NoteWait(std::nullopt);
      if (waits_for_lanes_) return GiveRoom(rested, giving_way_.IsInTheWay(place()));
      // The route may be closed for a moment only. In the planned traffic it waits for its next move.
      if (rested < kNoWaySeconds || (plan_ && !is_unreachable_)) return;
      tasks_.LeaveOut(*now_);
      rest_since_.reset();
    } else if (target_ && tasks_.Rest(*now_, rested, command_)) {
      rest_since_.reset();
    } else if (plan_) {
      return;  // others make it move
    } else if (was_aside) {
      GiveRoom(2.0 * rested, GivingWay::IsAskedForRoom(place(), Vec2::Zero()));
    } else if (!target_) {
      GiveRoom(rested, giving_way_.IsInTheWay(place()));
    }
  }

  // A robot that has waited for `rested` s, or has no destination, makes room for one that asks for it.
  void GiveRoom(double rested, bool is_asked) {
    if (is_asked && rested < GivingWay::kPoliteSeconds) return;
    const bool has_gone = is_asked && Take(giving_way_.StepAside(place()));
    if (has_gone || !tasks_.is_aside()) rest_since_ = now_->time;
  }

  // Along the present leg.

  void Follow() {
    if (plan_ && !plan_->takes_part()) return NoteWait(std::nullopt);
    const Leg leg = legs_.front();
    if (!leg.lane && leg.from != leg.to) return Ride(leg);
    if (!is_on_leg_) {
      if (IsDelayed()) return;
      is_on_leg_ = MayEnter(leg);
      if (!is_on_leg_) {
        if (!rest_since_) rest_since_ = now_->time;
        if (plan_) return;
        return GiveRoom(now_->time - *rest_since_, GivingWay::IsAskedForRoom(place(), WayOf(leg)));
      }
      if (settings_.close_doors) controls_.Note(lane(*leg.lane));
    }
    if (KeepsLift(leg)) Drive(leg);
  }

  // Before a move of the planned traffic, by one draw for each.
  bool IsDelayed() {
    if (!plan_ || settings_.delay_probability == 0.0) return false;
    if (drawn_for_ != plan_->finished()) {
      drawn_for_ = plan_->finished();
      const bool has_delay = now_->Random(0) < settings_.delay_probability;
      const double range = settings_.delay_max - settings_.delay_min;
      delayed_until_ = has_delay ? now_->time + settings_.delay_min + range * now_->Random(1) : 0.0;
    }
    return now_->time < delayed_until_;
  }

  // A user may call the lift away while the robot is on its leg into or out of the cabin, and another robot may get the
  // session then: it calls the lift again, and does not drive at closing doors. False: it has no way in this tick.
  bool KeepsLift(const Leg& leg) {
    if (!leg.lane || vertex(leg.from).lift == vertex(leg.to).lift) return true;
    const bool enters = vertex(leg.to).lift.has_value();
    const std::size_t in = enters ? leg.to : leg.from;
    controls_.CallLift(in);
    if (controls_.StandsOpenAt(in)) return true;
    NoteWaitForLift(in);
    switch (controls_.PlaceAt(in, position(), radius_)) {
      case SiteControls::AtCabin::kInside:
        return enters;
      case SiteControls::AtCabin::kOutside:
        return !enters;
      case SiteControls::AtCabin::kInDoorway:
        if (!enters) return true;
        if (controls_.IsOfAnother(in)) BackOut(leg);
        return false;  // the doors open again
    }
    return true;
  }

  // Out of a doorway that another robot's call closes, to the start of the leg.
  void BackOut(const Leg& leg) {
    if (plan_) {
      is_on_leg_ = false;  // it asks again for what it needs
      return;
    }
    legs_ = {{leg.from, leg.from, {}}};
    is_on_leg_ = true;
    backs_out_ = true;
    held_.clear();  // it asks again for what it needs
  }

  void Finish(const Leg& leg) {
    backs_out_ = false;
    if (leg.lane) giving_way_.OnPassed(*leg.lane);
    at_ = leg.to;
    if (plan_ && has_arrived_) plan_->Finish();
    has_arrived_ = true;
    legs_.erase(legs_.begin());
    is_on_leg_ = false;
    turn_.Forget();
    rest_since_.reset();
    if (legs_.empty() && target_ == at_ && !vertex(at_).dock.empty()) {
      command_.report = fmt::format("docked at {}", vertex(at_).dock);
    }
  }

  void Ride(const Leg& leg) {
    is_on_leg_ = true;  // it is not left for another target
    controls_.CallLift(leg.to);
    if (controls_.StandsOpenAt(leg.to)) Finish(leg);
  }

  // The vertices whose lifts the robot keeps: of the next two legs, and the vertex that it is at.
  std::vector<std::size_t> NeededVertices() const {
    std::vector<std::size_t> needed;
    for (std::size_t i = 0; i < std::min<std::size_t>(legs_.size(), 2); ++i) {
      needed.push_back(legs_[i].from);
      needed.push_back(legs_[i].to);
    }
    if (target_ != at_) needed.push_back(at_);
    return needed;
  }

  // At the start of a leg: what has to be there before it. Lifts come first, because another robot may need a group to
  // leave one; groups come last, because a robot that has them moves.
  bool MayEnter(const Leg& leg) {
    if (around_ && !plan_ &&
        FindUnreleased(around_->world(), around_->state, now_->pose_estimate, vertex(leg.to).position)) {
      NoteWait(std::nullopt);
      return false;
    }
    const std::optional<std::uint32_t> lift = vertex(leg.from).lift;
    if (lift) {  // out of a cabin
      controls_.CallLift(leg.from);
      if (!controls_.StandsOpenAt(leg.from)) {
        NoteWaitForLift(leg.from);
        return false;
      }
    }
    for (std::size_t i = 0; i < std::min<std::size_t>(legs_.size(), 2); ++i) {
      const std::size_t to = legs_[i].to;
      if (!vertex(to).lift || vertex(to).lift == lift || !legs_[i].lane) continue;
      const bool is_called = controls_.AwaitLift(to, others_);
      if (is_called && (i > 0 || (controls_.StandsOpenAt(to) && !IsTaken(vertex(to), others_, radius_)))) continue;
      NoteWaitForLift(to);
      return false;
    }
    for (const SiteControls::DoorAhead& ahead : controls_.DoorsAhead(legs_, position(), 0.0, radius_)) {
      if (ahead.way_before > 0.0 || controls_.OpenDoor(*ahead.door)) continue;
      NoteWaitForDoor(*ahead.door);
      if (controls_.IsStuck(*ahead.door)) ObstructByDoor(*ahead.door, leg, 0.0);
      return false;
    }
    return plan_ || EnterGroups(leg);
  }

  bool EnterGroups(const Leg& leg) {
    std::vector<std::string> needed;
    for (const std::string& group : {lane(*leg.lane).mutex, vertex(leg.to).mutex}) {
      if (group.empty()) continue;
      needed.push_back(group);
      if (std::find(held_.begin(), held_.end(), group) != held_.end()) continue;
      const MutexGroup::View view = groups_.at(group).Look(*graph_, others_);
      if (turn_.MayEnter(view, id_, now_->time)) continue;
      NoteWait(std::nullopt);
      if (view.holder) Block(*view.holder, leg);
      return false;
    }
    held_ = std::move(needed);
    return true;
  }

  void Drive(const Leg& leg) {
    const Vec2 end = vertex(leg.to).position;
    const bool is_docking = legs_.size() == 1 && target_ == leg.to && !vertex(leg.to).dock.empty();
    const double tolerance = is_docking ? std::min(settings_.tolerance, kDockTolerance) : settings_.tolerance;
    const Vec2 way = leg.lane ? WayOf(leg) : Vec2(end - position());
    const double length = way.norm();
    const double rest = (end - position()).norm();
    if (rest <= tolerance || length == 0.0) return Finish(leg);
    const Vec2 along = way / length;
    const double at = leg.lane ? std::clamp((position() - vertex(leg.from).position).dot(along), 0.0, length) : 0.0;
    // It has passed the end beside it: turning back for centimetres would look and be worse.
    if (leg.lane && at >= length && rest < 3.0 * tolerance && !is_docking) return Finish(leg);
    const Vec2 aim = leg.lane ? Vec2(vertex(leg.from).position + std::min(at + kLookAhead, length) * along) : end;

    double most = steer_.speed;
    if (PausesAfter(0, along)) most = std::min(most, BrakingSpeed(drive_, rest));
    if (is_docking && rest < kLookAhead) most = std::min(most, settings_.dock_speed);
    const double limit = leg.lane ? lane(*leg.lane).speed_limit : 0.0;
    if (limit > 0.0) most = std::min(most, limit);
    if (around_) {
      const double z = now_->pose_estimate.z;
      most = std::min(most, AllowedSpeed(*around_, leg.lane, *graph_, position(), along, z));
    }
    for (const SiteControls::DoorAhead& ahead : controls_.DoorsAhead(legs_, position(), at, radius_)) {
      if (controls_.OpenDoor(*ahead.door)) continue;
      most = std::min(most, BrakingSpeed(drive_, ahead.way_before));
      if (most < kCreep) NoteWaitForDoor(*ahead.door);
      if (most < kCreep && controls_.IsStuck(*ahead.door)) return ObstructByDoor(*ahead.door, leg, at);
    }
    const Vec2 start = leg.lane ? Vec2(vertex(leg.from).position + at * along) : position();
    if (const std::optional<LaneObstacle> obstacle = FindObstacleOnWay(start, along, length - at, tolerance)) {
      most = std::min(most, BrakingSpeed(drive_, obstacle->room));
      if (most < kCreep) {
        waits_for_mover_ = obstacle->is_person;
        NoteWait(obstacle->model);
        return Obstruct(obstacle->name, leg, at);
      }
    }
    SteerTo(aim, most, leg, at);
  }

  // The first obstacle on `way` m along `along` from `start`, for the robot on that line: one beside it returns to it.
  std::optional<LaneObstacle> FindObstacle(const Vec2& start, const Vec2& along, double way, bool backward) const {
    if (!around_) return std::nullopt;
    const double heading = Atan2(along.y(), along.x());
    const Pose X_WR{start.x(), start.y(), now_->pose_estimate.z, backward ? WrapAngle(heading + kPi) : heading};
    return FindObstacleAhead(*around_, id_, X_WR, along, way);
  }

  // What is on the rest of the present leg, less the gap that it keeps, or on those after it that it begins without a
  // pause. For the latter there is room at least to the end of the present leg. `tolerance`: m, that it ends before.
  std::optional<LaneObstacle> FindObstacleOnWay(Vec2 start, Vec2 along, double rest, double tolerance) const {
    double before = 0.0;  // m, of the legs before
    for (std::size_t i = 0;; ++i) {
      const double most = i == 0 ? std::min(rest - tolerance, kSeeAhead) : std::min(rest, kSeeAhead - before);
      std::optional<LaneObstacle> obstacle = FindObstacle(start, along, most, DrivesBackward(legs_[i]));
      if (obstacle) {
        const double gap = obstacle->is_person ? kPersonGap : settings_.gap;
        obstacle->room = i == 0 ? obstacle->room - gap : before + std::max(obstacle->room - gap, 0.0);
        // It may come as far as the robot goes.
        if (obstacle->comes) obstacle->room *= 0.5;
        return obstacle;
      }
      before += rest;
      if (before >= kSeeAhead || PausesAfter(i, along)) return std::nullopt;
      const Vec2 way = WayOf(legs_[i + 1]);
      start = vertex(legs_[i + 1].from).position;
      rest = way.norm();
      along = way / rest;
    }
  }

  // At the end of the leg `i`, along that: it stands there, waits, or turns.
  bool PausesAfter(std::size_t i, const Vec2& along) const {
    if (legs_.size() < i + 2 || !legs_[i + 1].lane) return true;
    const Leg& next = legs_[i + 1];
    const Lane& there = lane(*next.lane);
    if (!there.mutex.empty() || !vertex(next.to).mutex.empty() || vertex(next.to).lift) return true;
    if (legs_.size() > i + 2 && vertex(legs_[i + 2].to).lift) return true;
    if (!there.doors.empty() || there.facing != LaneFacing::kAny) return true;
    const Vec2 way = WayOf(next);
    return way.norm() == 0.0 || way.normalized().dot(along) < kStraightOn;
  }

  bool DrivesBackward(const Leg& leg) const {
    if (!can_turn() || drive_.velocity.x.min >= 0.0) return false;
    if (!leg.lane) return backs_out_;
    const LaneFacing facing = lane(*leg.lane).facing;
    if (facing == LaneFacing::kAny) return false;
    return (facing == LaneFacing::kBackward) == (leg.from == lane(*leg.lane).start);
  }

  // `at`: m along the leg.
  void SteerTo(const Vec2& aim, double most, const Leg& leg, double at) {
    const Vec2 offset = aim - position();
    const double distance = offset.norm();
    if (distance == 0.0) return;
    const std::optional<RobotAhead> ahead =
        FindRobotAhead(others_, position(), now_->pose_estimate.z, offset / distance, kSeeAhead, radius_, half_width_);
    const double sign = DrivesBackward(leg) ? -1.0 : 1.0;
    const Vec2 p_R = sign * Transform2(now_->pose_estimate).InverseTransform(aim);
    const bool turns = can_turn() && std::fabs(Atan2(p_R.y(), p_R.x())) > kTurnFirst;
    if (turns && WaitsBeforeTurn(Atan2(p_R.y(), p_R.x()), leg, at)) return;
    if (ahead) most = std::min(most, BrakingSpeed(drive_, ahead->room - settings_.gap));
    if (ahead && most < kCreep && !turns) {
      if (leg.lane && at < kAtStart) is_on_leg_ = false;  // it asks again for what it needs
      return Block(ahead->robot.id, leg, at);
    }
    const Command motion = SteerToPoint(drive_, steer_, p_R, turns ? 0.0 : most);
    command_.twist = {sign * motion.twist.vx, motion.twist.vy, motion.twist.wz};
    command_.speed = motion.speed;
    command_.steering = motion.steering;
  }

  // A corner of its body would touch a person or another robot in a turn on the spot: these may move on. Things that
  // stand are no reason to wait.
  bool WaitsBeforeTurn(double bearing, const Leg& leg, double at) {
    if (!around_) return false;
    const double angle = std::clamp(bearing, -kTurnAhead, kTurnAhead);
    const std::optional<ContactAhead> contact = FindContactInTurn(*around_, id_, now_->pose_estimate, angle);
    if (!contact) return false;
    const std::optional<RobotId> robot = around_->scene.robot_of(contact->model);
    const std::optional<PersonId> person = around_->scene.person_of(contact->model);
    if (!robot && !person) return false;
    waits_for_mover_ = true;
    if (robot) {
      Block(*robot, leg, at);
    } else {
      const ModelId root = around_->world().person(*person).root;
      NoteWait(root);
      Obstruct(around_->world().model(root).name, leg, at);
    }
    return true;
  }

  // Another robot is in the way.
  void Block(RobotId other, const Leg& leg, double at = 0.0) {
    is_blocked_ = true;
    NoteWaitForRobot(other);
    if (plan_) {
      // The plan has the turns of robots; one that stays is not where the plan takes it to be, or takes no part.
      if (has_arrived_) ObstructMove(NameOfRobot(other), leg);
      return;
    }
    std::optional<BlockEnd> end = giving_way_.OnBlocked(place(), other, leg, is_on_leg_ && at >= kAtStart);
    if (!end) return;
    End(*std::move(end), NameOfRobot(other), leg);
  }

  std::string NameOfRobot(RobotId robot) const { return around_ ? around_->world().robot(robot).name : ""; }

  void ObstructByDoor(const LaneDoor& door, const Leg& leg, double at) {
    Obstruct(fmt::format("door {}, which does not open,", controls_.NameOf(door)), leg, at);
  }

  // Something that is no robot is in the way.
  void Obstruct(const std::string& what, const Leg& leg, double at) {
    is_blocked_ = true;
    if (plan_ && has_arrived_) return ObstructMove(what, leg);
    if (!leg.lane) return ObstructStart(what);
    if (at < kAtStart) is_on_leg_ = false;  // it asks again for what it needs
    const Vec2 way = WayOf(leg);
    const double length = way.norm();
    const bool is_away = is_on_leg_;
    const auto is_back_free = [&] {
      const std::optional<LaneObstacle> behind =
          FindObstacle(vertex(leg.from).position + at / length * way, -way / length, at, false);
      return !behind || behind->walks;
    };
    std::optional<BlockEnd> end = giving_way_.OnObstacle(place(), leg, is_away, is_away && is_back_free());
    if (!end) return;
    const bool has_way = end->way.has_value();
    End(*std::move(end), what, leg);
    if (!has_way && tasks_.is_aside()) tasks_.LeaveOut(*now_);
  }

  // In the planned traffic: after a while the plan leads round it, if there is a way.
  void ObstructMove(const std::string& what, const Leg& leg) {
    if (!obstructed_since_) obstructed_since_ = now_->time;
    if (now_->time - *obstructed_since_ < GivingWay::kObstacleSeconds || asks_for_way_) return;
    asks_for_way_ = true;
    command_.report = fmt::format("{} is in the way {}: asks for another way", what, NameOfWay(leg));
  }

  // "from a to b": along the lane of the site.
  std::string NameOfWay(const Leg& leg) const {
    std::size_t from = leg.from;
    std::size_t to = leg.to;
    if (leg.lane) {
      const WholeLane whole = WholeLaneOf(*graph_, *leg.lane);
      const bool is_forward = leg.from == lane(*leg.lane).start;
      from = is_forward ? whole.start : whole.end;
      to = is_forward ? whole.end : whole.start;
    }
    return fmt::format("from {} to {}", NameOf(*graph_, from), NameOf(*graph_, to));
  }

  // Before it is on a lane: another vertex may be free.
  void ObstructStart(const std::string& what) {
    if (!start_blocked_since_) start_blocked_since_ = now_->time;
    if (backs_out_ || now_->time - *start_blocked_since_ < GivingWay::kObstacleSeconds) return;
    const std::optional<std::size_t> other = FindClearVertex(kAnyVertex);
    if (!other && has_said_start_) return;
    has_said_start_ = !other;
    command_.report = fmt::format("{} is in the way to {}: {}", what, NameOf(*graph_, at_),
                                  other ? "goes to " + NameOf(*graph_, *other) : "waits");
    if (other) GoStraightTo(*other);
  }

  void End(BlockEnd end, const std::string& what, const Leg& leg) {
    if (end.closed) {
      std::string then = "waits";
      if (end.way && end.way->seconds_aside) {
        then = "goes aside, and tries again";
      } else if (end.way) {
        then = fmt::format("{}; the lane counts as closed for {:.0f} s", target_ ? "goes round" : "goes back",
                           *end.closed);
      } else if (target_) {
        then = "waits, since there is no better way to " + NameOf(*graph_, *target_);
      }
      command_.report = fmt::format("{} is in the way {}: {}", what, NameOfWay(leg), then);
    }
    Take(std::move(end.way));
  }

  // False if there is no such way.
  bool Take(std::optional<WayAround> way) {
    if (!way) return false;
    legs_ = std::move(way->legs);
    is_on_leg_ = way->is_on_first;
    if (!way->seconds_aside) return true;
    target_ = legs_.back().to;
    tasks_.GoAside(*target_, *way->seconds_aside, at_);
    return true;
  }

  RobotId id_;
  LaneSettings settings_;
  const LaneGraph* graph_;
  DriveDescription drive_;
  SteerSettings steer_;
  Recovery recovery_;
  LaneTasks tasks_;
  SiteControls controls_;
  GivingWay giving_way_;
  std::map<std::string, MutexGroup> groups_;
  std::size_t first_lane_ = 0;  // of its graph, among those of all
  std::vector<double> radii_;   // by robot
  double radius_ = 0.0;
  double half_width_ = 0.0;

  // Of this tick.
  std::optional<Surroundings> around_;
  const Observation* now_ = nullptr;
  Command command_;
  std::vector<SeenRobot> others_;
  bool is_blocked_ = false;
  std::optional<WaitOrder> wait_;  // it cannot go on

  bool waits_for_mover_ = false;            // in the last tick
  std::optional<PlannedWay> plan_;          // nothing: it finds its own way
  bool has_arrived_ = false;                // at a vertex, since the start
  std::uint32_t touching_ticks_ = 0;        // with a contact on the present lane
  std::optional<double> obstructed_since_;  // s, simulated: on a granted move
  bool asks_for_way_ = false;
  bool has_said_taken_ = false;
  std::optional<std::uint32_t> drawn_for_;  // finished moves, for which a delay has been drawn
  double delayed_until_ = 0.0;              // s, simulated

  bool has_started_ = false;
  std::size_t at_ = 0;                         // the vertex that it was at last
  std::vector<Leg> legs_;                      // to do, the present one first
  bool is_on_leg_ = false;                     // false: it waits at the start
  bool backs_out_ = false;                     // the present leg leads back out of a doorway
  std::optional<double> start_blocked_since_;  // s, simulated: on a leg without a lane
  bool has_said_start_ = false;
  std::optional<std::size_t> target_;
  bool is_unreachable_ = false;
  BarredLanes barred_;
  bool has_new_bars_ = false;
  bool waits_for_lanes_ = false;   // only barred lanes lead to its target
  std::vector<std::string> held_;  // mutex groups of the present leg
  MutexTurn turn_;
  std::optional<double> rest_since_;  // s, simulated
};

Status CheckLanes(const std::string& parameters) {
  const Result<LaneSettings> settings = ParseLaneSettings(parameters);
  return settings.ok() ? Status() : settings.error();
}

Result<std::unique_ptr<Controller>> CreateLanes(const RobotInfo& info) {
  const Result<LaneSettings> settings = ParseLaneSettings(info.parameters);
  if (!settings.ok()) return settings.error();
  const Result<const LaneGraph*> graph = FindLanes(settings.value(), info);
  if (!graph.ok()) return graph.error();
  return std::unique_ptr<Controller>(std::make_unique<LanesController>(info, settings.value(), *graph.value()));
}

Status CheckLanesInWorld(const RobotInfo& info) {
  const Result<LaneSettings> settings = ParseLaneSettings(info.parameters);
  if (!settings.ok()) return settings.error();
  const Result<const LaneGraph*> graph = FindLanes(settings.value(), info);
  return graph.ok() ? Status() : graph.error();
}

// From the vertex nearest to the robot: at the speed of 1 m/s, since a way does not depend on it.
Status CheckGoalOnLanes(const RobotInfo& info, const Pose& X_WR, const Goal& goal) {
  const Result<LaneSettings> settings = ParseLaneSettings(info.parameters);
  if (!settings.ok()) return settings.error();
  const Result<const LaneGraph*> found = FindLanes(settings.value(), info);
  if (!found.ok()) return found.error();
  const LaneGraph& graph = *found.value();
  std::size_t at = FindNearestVertex(graph, X_WR.translation(), X_WR.z, kOnOneLevel)->vertex;
  for (const std::size_t vertex : VerticesOf(goal, graph, X_WR.z)) {
    if (!FastestRoute(graph, at, vertex, 1.0)) {
      return BadInput(fmt::format("no lanes lead from {} to {}", NameOf(graph, at), NameOf(graph, vertex)));
    }
    at = vertex;
  }
  return Status();
}

}  // namespace

BuiltInController Lanes() {
  return {"lanes", CheckLanes, CreateLanes, CheckLanesInWorld, CheckGoalOnLanes};
}

}  // namespace troupe
