// slotcar: drives along paths: of Open-RMF, which come by ROS (robot-agent/ros/slotcar_port.h), or goals of users.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/controller/path_follower.h"
#include "troupe/deterministic_math.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

constexpr double kReached = 0.02;              // m
constexpr double kReachedHeld = 0.04;          // m: turning in place may move it
constexpr double kReachedByCar = 0.5;          // m
constexpr double kMaxStartDistance = 1.0;      // m
constexpr double kFacing = 5.0 * kPi / 180.0;  // rad: it drives towards a point that is not farther to a side
constexpr double kYawTolerance = 0.01;         // rad
constexpr double kMaxBraking = 100.0;          // m/s^2, rad/s^2: stops within any tick

}  // namespace

// docs/controllers.md has the units and defaults.
Result<SlotcarParameters> ReadSlotcarParameters(const std::string& text) {
  SlotcarParameters p;
  Parameters reader("slotcar", text);
  p.speed = reader.ReadNumber("speed", {0.0, 100.0}).value_or(p.speed);
  p.turn_rate = reader.ReadNumber("turn_rate", {0.0, 100.0}).value_or(p.turn_rate);
  p.stop_distance = reader.ReadNumber("stop_distance", {0.0, 100.0}).value_or(p.stop_distance);
  p.stop_radius = reader.ReadNumber("stop_radius", {0.0, 100.0}).value_or(p.stop_radius);
  if (std::optional<std::string> fleet = reader.ReadText("fleet")) {
    p.fleet = *std::move(fleet);
    if (p.fleet.empty()) reader.Fail("'fleet' is '', expected a name");
  }
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

double SpeedFor(double way, double most, double braking, double seconds) {
  const double a = std::clamp(braking, 1e-3, kMaxBraking);
  // For whole ticks: v such that after this tick at v, braking by a in each further tick ends within the way.
  // The positive root of v (v / a + seconds) / 2 = way: the speed falls in steps of ticks, not continuously.
  const double half = 0.5 * a * seconds;
  return std::max(std::min({most, way / seconds, std::sqrt(half * half + 2.0 * a * way) - half}), 0.0);
}

// False: the path begins too far away; the robot stands.
bool PathFollower::Follow(std::vector<PathPoint> path, const Vec2& at) {
  was_held_ = false;
  if ((path.front().position - at).norm() > kMaxStartDistance) {
    Clear();
    return false;
  }
  path_ = std::move(path);
  next_ = 1;
  return true;
}

void PathFollower::Clear() {
  path_.clear();
  next_ = 0;
  was_held_ = false;
  state_ = State::kStands;
}

void PathFollower::SetPause(Pause pause, std::uint64_t checkpoint) {
  pause_ = pause;
  checkpoint_ = checkpoint;
}

bool PathFollower::Holds(const PathPoint& point, double time) const {
  return pause_ == Pause::kNow || (pause_ == Pause::kAtCheckpoint && checkpoint_ <= point.index) || time < point.time;
}

double PathFollower::TurnBy(double angle, double interval) const {
  if (drive_.type == DriveType::kCar || std::fabs(angle) < kYawTolerance) return 0.0;
  const double most = std::min(parameters_.turn_rate, drive_.velocity.heading.max);
  return std::copysign(SpeedFor(std::fabs(angle), most, -drive_.acceleration.heading.min, interval), angle);
}

Twist PathFollower::DriveTo(const PathPoint& point, const Pose& X_WR, double interval) const {
  const Vec2 p_R = Transform2(X_WR).InverseTransform(point.position);
  const double distance = p_R.norm();
  double most = parameters_.speed;
  if (point.speed_limit > 0.0) most = std::min(most, point.speed_limit);
  if (drive_.type == DriveType::kCar) {
    // On the arc through the point; a car does not stop at the points on its way.
    const double speed = SpeedFor(next_ + 1 == path_.size() ? distance : 1e6, std::min(most, drive_.velocity.x.max),
                                  -drive_.acceleration.x.min, interval);
    return {speed, 0.0, speed * 2.0 * p_R.y() / std::max(distance * distance, 1e-6)};
  }
  // A point behind the robot is reached backwards where the drive can, with the smaller turn.
  const bool reverses = p_R.x() < 0.0 && drive_.velocity.x.min < 0.0;
  const double bearing = reverses ? Atan2(-p_R.y(), -p_R.x()) : Atan2(p_R.y(), p_R.x());
  Twist twist{0.0, 0.0, TurnBy(bearing, interval)};
  // It turns on the spot until it faces the point, and so leaves the line to the point little.
  if (std::fabs(bearing) >= kFacing) return twist;
  const double speed = SpeedFor(distance, std::min(most, reverses ? -drive_.velocity.x.min : drive_.velocity.x.max),
                                reverses ? drive_.acceleration.x.max : -drive_.acceleration.x.min, interval);
  twist.vx = reverses ? -speed : speed;
  return twist;
}

Twist PathFollower::Update(const Pose& X_WR, double time, double interval, bool is_blocked) {
  const bool was_held = std::exchange(was_held_, false);
  state_ = State::kStands;
  if (path_.empty()) return {};
  const double reached = drive_.type == DriveType::kCar ? kReachedByCar : was_held ? kReachedHeld : kReached;
  // Several points may be reached at once: paths of fleets repeat a point to wait or to turn there.
  while (next_ < path_.size() && (path_[next_].position - X_WR.translation()).norm() < reached) {
    if (Holds(path_[next_], time)) {
      was_held_ = true;
      state_ = State::kHolds;
      return {0.0, 0.0, TurnBy(WrapAngle(path_[next_].heading - X_WR.heading), interval)};
    }
    ++next_;
  }
  Twist twist;
  if (next_ < path_.size()) {
    twist = DriveTo(path_[next_], X_WR, interval);
  } else {
    twist.wz = TurnBy(WrapAngle(path_.back().heading - X_WR.heading), interval);
  }
  if (twist == Twist()) return twist;
  state_ = pause_ == Pause::kNow ? State::kHolds : is_blocked && twist.vx != 0.0 ? State::kWaits : State::kDrives;
  if (state_ != State::kDrives) twist.vx = 0.0;
  // A car does not turn where it stands.
  if (drive_.type == DriveType::kCar && twist.vx == 0.0) return {};
  return twist;
}

namespace {

class Slotcar final : public Controller {
 public:
  Slotcar(const DriveDescription& drive, const SlotcarParameters& parameters)
      : drive_(drive), follower_(drive, parameters) {}

  bool AcceptsGoals() const override { return true; }

  Command Update(const Observation& observation) override {
    const Goal* const goal = observation.goal;
    if (goal == nullptr) {
      follower_.Clear();
      goal_.reset();
    } else if (goal_ != goal->number) {
      goal_ = goal->number;
      // Follow expects a path that begins near the robot.
      std::vector<PathPoint> path = {{observation.pose_estimate.translation()}};
      for (const Vec2& point : goal->waypoints) path.push_back({point, observation.pose_estimate.heading});
      if (goal->heading) path.back().heading = *goal->heading;
      follower_.Follow(std::move(path), observation.pose_estimate.translation());
    }
    const Twist twist = follower_.Update(observation.pose_estimate, observation.time, observation.interval, false);
    Command command;
    command.twist = twist;
    if (drive_.type == DriveType::kCar && twist.vx != 0.0) {
      command.speed = twist.vx;
      command.steering = Atan2(twist.wz * drive_.wheelbase, twist.vx);
    }
    return command;
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<Slotcar>(*this); }

 private:
  DriveDescription drive_;
  PathFollower follower_;
  std::optional<std::uint32_t> goal_;  // number
};

}  // namespace

BuiltInController SlotcarController() {
  return {"slotcar",
          [](const std::string& parameters) -> Status {
            const Result<SlotcarParameters> read = ReadSlotcarParameters(parameters);
            return read.ok() ? Status() : Status(read.error());
          },
          [](const RobotInfo& info) -> Result<std::unique_ptr<Controller>> {
            const Result<SlotcarParameters> read = ReadSlotcarParameters(info.parameters);
            if (!read.ok()) return read.error();
            return std::unique_ptr<Controller>(std::make_unique<Slotcar>(info.robot->drive, read.value()));
          }};
}

}  // namespace troupe
