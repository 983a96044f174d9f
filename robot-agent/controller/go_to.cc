// go_to and patrol: drive to places, once or round after round. Both accept goals of users.
//
// A goal of a user comes from the page, troupectl, ROS or a tool, as an input of the tick. It replaces the route of the
// parameters until it is cancelled or expires; then the route begins again. A waypoint is reached within the tolerance,
// without stopping, except for the last one.
//
// Ways to goals are searched on the map of the world (robot-agent/navigation/goal_way.h); the route of the parameters
// is driven in straight lines, unless `plan` is set. The map is matched to the surroundings, while the goal stays where
// the robot's estimate has it: it drifts as odometry does.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/base/json_reader.h"
#include "common/geometry/limits.h"
#include "common/model/goal_text.h"
#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/goal_way.h"
#include "robot-agent/navigation/steering.h"
#include "robot-agent/navigation/surroundings.h"
#include "troupe/deterministic_math.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

constexpr double kHeadingTolerance = 0.02;  // rad
constexpr double kBackOffTime = 1.0;        // s, after a stall
constexpr double kFacing = 0.85;            // cosine: it drives on a way once it faces it

struct GoToParameters {
  SteerSettings steer;
  double tolerance = 0.1;         // m: a waypoint within it is reached
  std::vector<Vec2> waypoints;    // m, in the frame of the robot's estimate
  std::optional<double> heading;  // rad, at the last one
  bool plan = false;              // search ways to waypoints, too
};

Result<GoToParameters> ParseGoTo(const char* name, bool repeats, const std::string& text) {
  GoToParameters p;
  Parameters reader(name, text);
  if (const std::optional<JsonReader> list = reader.reader().Find("waypoints")) {
    for (const JsonReader& point : list->Items(kMaxWaypoints)) {
      if (const auto xy = point.Numbers(2, kMaxMagnitude)) p.waypoints.emplace_back((*xy)[0], (*xy)[1]);
    }
  }
  if (!repeats) p.heading = reader.ReadNumber("heading", {-2.0 * kPi, 2.0 * kPi});
  p.steer.speed = reader.ReadNumber("speed", {0.0, 100.0}).value_or(p.steer.speed);
  p.steer.turn_rate = reader.ReadNumber("turn_rate", {0.0, 100.0}).value_or(p.steer.turn_rate);
  p.tolerance = reader.ReadNumber("tolerance", {0.001, 100.0}).value_or(p.tolerance);
  p.plan = reader.ReadBool("plan").value_or(p.plan);
  if (repeats && p.waypoints.size() < 2)
    reader.Fail("'waypoints' has fewer than 2 points, expected [[x, y], [x, y], ...]");
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

class GoToController final : public Controller, public RobotWatcher {
 public:
  GoToController(const RobotInfo& info, GoToParameters parameters, bool repeats)
      : parameters_(std::move(parameters)),
        id_(info.id),
        drive_(info.robot->drive),
        recovery_(drive_, parameters_.steer),
        repeats_(repeats),
        way_(info.id, drive_) {
    RestartRoute();
  }

  bool AcceptsGoals() const override { return true; }

  void WatchRobots(const Surroundings& around) override { around_.emplace(around); }

  Command Update(const Observation& observation) override {
    FollowGoal(observation.goal);
    const bool is_stuck = observation.stalled && observation.time >= back_off_until_;
    // A manoeuvre that was blocked from its start to its end is not repeated.
    const double patience = is_stuck ? std::max(observation.time - stalled_at_, Recovery::kPatience) : Recovery::kNever;
    if (const std::optional<Command> recovery = recovery_.Update(observation, patience)) {
      back_off_until_ = observation.time;
      way_.Restart();
      if (next_ == route_.size() && next_ > 0) --next_;  // the recovery leads away from the last waypoint
      return *recovery;
    }
    if (is_stuck) {
      stalled_at_ = observation.time;
      back_off_until_ = observation.time + kBackOffTime;
      back_off_turn_ = observation.Random(0) < 0.5 ? 1.0 : -1.0;
      way_.Restart();
    }
    if (goal_ && given_up_ == goal_) return {};
    const Pose& X_ER = observation.pose_estimate;
    while (next_ < route_.size() &&
           (route_[next_] - X_ER.translation()).squaredNorm() <= parameters_.tolerance * parameters_.tolerance) {
      ++next_;
      if (next_ == route_.size() && repeats_ && !goal_) next_ = 0;
      if (repeats_ && !goal_) break;  // all of them may be here
    }
    if (next_ == route_.size()) return Arrive(X_ER);
    if (observation.time < back_off_until_) return BackOff();
    const Vec2 p_R = Transform2(X_ER).InverseTransform(route_[next_]);
    const bool is_last = next_ + 1 == route_.size() && (goal_ || !repeats_);
    const double most = is_last ? BrakingSpeed(drive_, std::sqrt(p_R.squaredNorm())) : parameters_.steer.speed;
    if (around_ && (goal_ || parameters_.plan)) return FollowWay(observation, p_R, most);
    return SteerToPoint(drive_, parameters_.steer, p_R, most);
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<GoToController>(*this); }

 private:
  // A goal of a user takes the place of the route, which begins again after it is cancelled or has expired.
  void FollowGoal(const Goal* goal) {
    if (goal == nullptr) {
      if (goal_) RestartRoute();
      return;
    }
    if (goal_ == goal->number) return;
    goal_ = goal->number;
    way_.Reset();
    route_ = goal->waypoints;
    heading_ = goal->heading;
    next_ = 0;
  }

  void RestartRoute() {
    goal_.reset();
    way_.Reset();
    route_ = parameters_.waypoints;
    heading_ = parameters_.heading;
    next_ = 0;
  }

  // Along the way to the next point, which is at p_R (m, frame R), no faster than `most` m/s.
  Command FollowWay(const Observation& observation, const Vec2& p_R, double most) {
    const Transform2 X_WR(around_->PoseOf(id_));
    const Result<GoalWay::Leg> leg = way_.Update(observation, *around_, X_WR * p_R);
    if (!leg.ok()) return GiveUp(leg.error().message);
    const Vec2 ahead_R = X_WR.InverseTransform(leg.value().point);
    Command command = SteerToPoint(drive_, parameters_.steer, ahead_R, std::min(most, leg.value().most));
    // It leaves its way only where it turns on the spot.
    if (ahead_R.x() < kFacing * ahead_R.norm()) command.twist.vx = 0.0;
    if (leg.value().door) command.orders.push_back(DoorOrder{.door = *leg.value().door});
    if (leg.value().wait) command.orders.push_back(*leg.value().wait);
    return command;
  }

  // A goal of a user ends here; of its own route the robot leaves a waypoint out.
  Command GiveUp(const std::string& reason) {
    Command command;
    const Vec2& point = route_[next_];
    command.say = fmt::format("{} ({:.2f}, {:.2f}): {}", goal_ ? kGaveUpGoal : "leaves out the waypoint", point.x(),
                              point.y(), reason);
    if (goal_) {
      given_up_ = goal_;
      return command;
    }
    way_.Reset();
    if (++next_ == route_.size() && repeats_) next_ = 0;
    return command;
  }

  // Says once that a user's goal is reached.
  Command Arrive(const Pose& X_ER) {
    Command command = TurnToHeading(X_ER.heading);
    if (goal_ && announced_ != goal_ && !route_.empty() && command.twist == Twist()) {
      command.say = fmt::format("reached the goal ({:.2f}, {:.2f})", route_.back().x(), route_.back().y());
      announced_ = goal_;
    }
    return command;
  }

  Command TurnToHeading(double present) const {
    Command command;
    if (!heading_ || drive_.type == DriveType::kCar) return command;
    const double error = WrapAngle(*heading_ - present);
    if (std::abs(error) <= kHeadingTolerance) return command;
    command.twist.wz = std::clamp(error, -parameters_.steer.turn_rate, parameters_.steer.turn_rate);
    return command;
  }

  Command BackOff() const {
    Command command;
    const double speed = -0.5 * parameters_.steer.speed;
    if (drive_.type == DriveType::kCar) {
      command.speed = speed;
      command.steering = drive_.velocity.heading.Clamp(back_off_turn_);
    } else {
      command.twist = {speed, 0.0, 0.5 * back_off_turn_ * parameters_.steer.turn_rate};
    }
    return command;
  }

  GoToParameters parameters_;
  RobotId id_;
  DriveDescription drive_;
  Recovery recovery_;
  bool repeats_;
  std::optional<std::uint32_t> goal_;       // the user's, while there is one
  std::optional<std::uint32_t> announced_;  // the last that was reached
  std::optional<std::uint32_t> given_up_;   // the last to which there was no way
  std::vector<Vec2> route_;
  std::optional<double> heading_;
  std::size_t next_ = 0;         // in route_
  double stalled_at_ = 0.0;      // s, simulated: when it last began to back off
  double back_off_until_ = 0.0;  // s, simulated
  double back_off_turn_ = 1.0;   // 1: to the left
  GoalWay way_;
  std::optional<Surroundings> around_;  // of this tick; nothing: the robot sees no other bodies
};

template <bool kRepeats>
constexpr const char* kName = kRepeats ? "patrol" : "go_to";

template <bool kRepeats>
Status CheckGoTo(const std::string& parameters) {
  const Result<GoToParameters> parsed = ParseGoTo(kName<kRepeats>, kRepeats, parameters);
  return parsed.ok() ? Status() : parsed.error();
}

template <bool kRepeats>
Result<std::unique_ptr<Controller>> CreateGoTo(const RobotInfo& info) {
  Result<GoToParameters> parameters = ParseGoTo(kName<kRepeats>, kRepeats, info.parameters);
  if (!parameters.ok()) return parameters.error();
  return std::unique_ptr<Controller>(std::make_unique<GoToController>(info, std::move(parameters).value(), kRepeats));
}

// follow: drives behind a model that its fiducial finder sees.

struct FollowParameters {
  SteerSettings steer;
  double distance = 1.0;  // m, that it keeps
  double id = 0.0;        // of the model; 0: the nearest of all
};

Result<FollowParameters> ParseFollow(const std::string& text) {
  FollowParameters p;
  Parameters reader("follow", text);
  p.id = reader.ReadNumber("id", {-1e9, 1e9}).value_or(p.id);
  p.distance = reader.ReadNumber("distance", {0.0, 1000.0}).value_or(p.distance);
  p.steer.speed = reader.ReadNumber("speed", {0.0, 100.0}).value_or(p.steer.speed);
  p.steer.turn_rate = reader.ReadNumber("turn_rate", {0.0, 100.0}).value_or(p.steer.turn_rate);
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

class FollowController final : public Controller {
 public:
  FollowController(const RobotInfo& info, const FollowParameters& parameters, std::size_t finder)
      : parameters_(parameters), drive_(info.robot->drive), recovery_(drive_, parameters.steer), finder_(finder) {}

  std::vector<std::size_t> Subscriptions() const override { return {finder_}; }

  Command Update(const Observation& observation) override {
    const FiducialReading* const reading = observation.sensors[finder_].As<FiducialReading>();
    if (reading == nullptr) return {};
    const double patience = observation.stalled ? Recovery::kPatience : Recovery::kNever;
    if (const std::optional<Command> recovery = recovery_.Update(observation, patience)) return *recovery;
    const Fiducial* const leader = FindLeader(*reading);
    if (leader == nullptr) return Search();
    const Vec2 p_R = (reading->X_RS * leader->X_SF).translation();
    side_ = p_R.y() >= 0.0 ? 1.0 : -1.0;
    const double rest = std::sqrt(p_R.squaredNorm()) - parameters_.distance;
    if (drive_.type == DriveType::kCar && rest <= 0.0) return {};
    return SteerToPoint(drive_, parameters_.steer, p_R, std::min(std::max(rest, 0.0), BrakingSpeed(drive_, rest)));
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<FollowController>(*this); }

 private:
  // Null if it sees none.
  const Fiducial* FindLeader(const FiducialReading& reading) const {
    const Fiducial* nearest = nullptr;
    for (const Fiducial& fiducial : reading.fiducials) {
      if (parameters_.id != 0.0 && static_cast<double>(fiducial.id) != parameters_.id) continue;
      if (nearest == nullptr || fiducial.range < nearest->range) nearest = &fiducial;
    }
    return nearest;
  }

  // It turns to the side on which it saw the leader last. A car waits.
  Command Search() const {
    Command command;
    if (drive_.type != DriveType::kCar) command.twist.wz = 0.5 * side_ * parameters_.steer.turn_rate;
    return command;
  }

  FollowParameters parameters_;
  DriveDescription drive_;
  Recovery recovery_;
  std::size_t finder_;
  double side_ = 1.0;  // 1: left
};

Status CheckFollow(const std::string& parameters) {
  const Result<FollowParameters> parsed = ParseFollow(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

Result<std::unique_ptr<Controller>> CreateFollow(const RobotInfo& info) {
  const Result<FollowParameters> parameters = ParseFollow(info.parameters);
  if (!parameters.ok()) return parameters.error();
  for (std::size_t i = 0; i < info.sensors.size(); ++i) {
    if (!std::holds_alternative<FiducialParameters>(info.sensors[i].description->parameters)) continue;
    return std::unique_ptr<Controller>(std::make_unique<FollowController>(info, parameters.value(), i));
  }
  return Error{{}, "follow: the robot has no fiducial finder, expected one"};
}

}  // namespace

BuiltInController GoTo() {
  return {.name = kName<false>, .check = CheckGoTo<false>, .create = CreateGoTo<false>, .check_way = CheckWayToGoal};
}

BuiltInController Patrol() {
  return {.name = kName<true>, .check = CheckGoTo<true>, .create = CreateGoTo<true>, .check_way = CheckWayToGoal};
}

BuiltInController Follow() {
  return {"follow", CheckFollow, CreateFollow};
}

}  // namespace troupe
