// fetch: picks objects up at some places and puts them down at others, step by step.
#include <algorithm>
#include <cmath>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/controller/fetch_plan.h"
#include "robot-agent/navigation/recovery.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kDistanceReached = 1e-6;  // m
constexpr double kAngleReached = 1e-9;     // rad
constexpr double kSteeringDistance = 0.1;  // m: nearer to its point, it drives straight on
constexpr double kSteeringGain = 2.0;      // 1/s
constexpr double kBlockedTime = 10.0;      // s blocked on its way, before a recovery

// The fastest speed (m/s or rad/s) that allows a stop after `way` at `deceleration`; the last one ends there exactly.
double Approach(double way, double speed, double deceleration, double interval) {
  const double size = std::abs(way);
  const double allowed = std::min({speed, std::sqrt(2.0 * deceleration * size), size / interval});
  return way < 0.0 ? -allowed : allowed;
}

// Half of the strongest deceleration of the drive, as a reserve.
double Deceleration(const Interval& bounds) {
  return 0.5 * std::min(-bounds.min, bounds.max);
}

class FetchController final : public Controller {
 public:
  FetchController(const RobotInfo& info, FetchPlan plan)
      : plan_(std::move(plan)), recovery_(info.robot->drive, {plan_.speed, plan_.turn_rate}) {
    const DriveDescription& drive = info.robot->drive;
    plan_.speed = std::min({plan_.speed, drive.velocity.x.max, -drive.velocity.x.min});
    plan_.turn_rate = std::min({plan_.turn_rate, drive.velocity.heading.max, -drive.velocity.heading.min});
    deceleration_ = Deceleration(drive.acceleration.x);
    turn_deceleration_ = Deceleration(drive.acceleration.heading);
  }

  Command Update(const Observation& observation) override {
    const bool is_stuck = observation.stalled && IsOnItsWay();
    const double patience = is_stuck ? kBlockedTime : Recovery::kNever;
    if (std::optional<Command> recovery = recovery_.Update(observation, patience)) {
      RestartWay();
      return *std::move(recovery);
    }
    Command command;
    while (next_ < plan_.steps.size() && IsDone(plan_.steps[next_], observation, command)) {
      ++next_;
      began_ = false;
      facing_ = false;
    }
    return command;
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<FetchController>(*this); }

 private:
  // Between places, where no place demands its exact pose.
  bool IsOnItsWay() const {
    if (next_ == plan_.steps.size()) return false;
    const FetchAction action = plan_.steps[next_].action;
    return action == FetchAction::kGoTo || action == FetchAction::kTurnTo;
  }

  // From the point to which it drove last: a recovery leads away from it.
  void RestartWay() {
    for (std::size_t i = next_ + 1; i-- > 0;) {
      if (plan_.steps[i].action != FetchAction::kGoTo) continue;
      next_ = i;
      break;
    }
    began_ = false;
    facing_ = false;
  }

  // Commands the next part of a step; true if the step is complete.
  bool IsDone(const FetchStep& step, const Observation& observation, Command& command) {
    const bool begins = !began_;
    began_ = true;
    switch (step.action) {
      case FetchAction::kGoTo:
        return GoTo(step, observation, command);
      case FetchAction::kTurnTo:
        return TurnTo(step.value, observation, command);
      case FetchAction::kDrive:
        if (begins) start_ = observation.pose_estimate;
        return DriveFromStart(step.value, observation, command);
      case FetchAction::kPush:
        if (begins) start_ = observation.pose_estimate;
        return (!begins && observation.stalled) || DriveFromStart(step.value, observation, command);
      case FetchAction::kOpen:
        if (begins) command.grippers.push_back({.fingers = FingerCommand::kOpen});
        return !begins && observation.grippers[0].fingers == FingerState::kOpen;
      case FetchAction::kClose:
        if (begins) command.grippers.push_back({.fingers = FingerCommand::kClose});
        return !begins && observation.grippers[0].fingers == FingerState::kClosed;
      case FetchAction::kLift:
        if (begins) command.grippers.push_back({.lift = step.value});
        return !begins && !observation.grippers[0].lift_moving;
      case FetchAction::kWait:
        if (begins) until_ = observation.time + step.value;
        return observation.time >= until_ - 0.5 * observation.interval;
      case FetchAction::kWaitUntil:
        return observation.time >= step.value - 0.5 * observation.interval;
    }
    return true;
  }

  bool TurnTo(double heading, const Observation& observation, Command& command) const {
    const double way = WrapAngle(heading - observation.pose_estimate.heading);
    if (std::abs(way) <= kAngleReached) return true;
    command.twist.wz = Approach(way, plan_.turn_rate, turn_deceleration_, observation.interval);
    return false;
  }

  bool GoTo(const FetchStep& step, const Observation& observation, Command& command) {
    const Pose& pose = observation.pose_estimate;
    const double dx = step.x - pose.x;
    const double dy = step.y - pose.y;
    const double distance = std::sqrt(dx * dx + dy * dy);
    if (!facing_) {
      if (distance <= kSteeringDistance) return DriveStraight(dx, dy, observation, command);
      if (!TurnTo(Atan2(dy, dx), observation, command)) return false;
      facing_ = true;
    }
    if (distance > kSteeringDistance) {
      const double error = WrapAngle(Atan2(dy, dx) - pose.heading);
      command.twist.wz = std::clamp(kSteeringGain * error, -plan_.turn_rate, plan_.turn_rate);
    }
    return DriveStraight(dx, dy, observation, command);
  }

  bool DriveFromStart(double distance, const Observation& observation, Command& command) const {
    const SinCosResult direction = SinCos(start_.heading);
    return DriveStraight(start_.x + distance * direction.cos - observation.pose_estimate.x,
                         start_.y + distance * direction.sin - observation.pose_estimate.y, observation, command);
  }

  // Along the robot's heading, to the foot of the point (dx, dy) away.
  bool DriveStraight(double dx, double dy, const Observation& observation, Command& command) const {
    const SinCosResult direction = SinCos(observation.pose_estimate.heading);
    const double way = dx * direction.cos + dy * direction.sin;
    if (std::abs(way) <= kDistanceReached) {
      command.twist = {};
      return true;
    }
    command.twist.vx = Approach(way, plan_.speed, deceleration_, observation.interval);
    return false;
  }

  FetchPlan plan_;
  Recovery recovery_;
  double deceleration_ = 0.0;       // m/s^2
  double turn_deceleration_ = 0.0;  // rad/s^2
  std::size_t next_ = 0;
  bool began_ = false;   // the next step
  bool facing_ = false;  // towards its target point
  Pose start_;           // of a straight drive
  double until_ = 0.0;   // s, simulated
};

Status CheckFetch(const std::string& parameters) {
  const Result<FetchPlan> plan = ParseFetchPlan(parameters);
  return plan.ok() ? Status() : plan.error();
}

Result<std::unique_ptr<Controller>> CreateFetch(const RobotInfo& info) {
  Result<FetchPlan> parsed = ParseFetchPlan(info.parameters);
  if (!parsed.ok()) return parsed.error();
  FetchPlan plan = std::move(parsed).value();
  if (info.robot->drive.type == DriveType::kCar) {
    return Error{{}, "fetch: the robot is a car, expected one that turns on the spot"};
  }
  if ((plan.needs_gripper || plan.needs_lift) && info.grippers.empty()) {
    return Error{{}, "fetch: the robot has no gripper, expected one for the steps 'gripper', 'lift', 'take' and 'put'"};
  }
  if (plan.needs_lift && !info.grippers[0].lift) {
    return Error{{}, "fetch: the robot's gripper has no lift, expected one for the steps 'lift', 'take' and 'put'"};
  }
  return std::unique_ptr<Controller>(std::make_unique<FetchController>(info, std::move(plan)));
}

}  // namespace

BuiltInController Fetch() {
  return {"fetch", CheckFetch, CreateFetch};
}

}  // namespace troupe
