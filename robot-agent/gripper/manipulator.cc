#include "robot-agent/gripper/manipulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace troupe {
namespace {

constexpr double kPercent = 100.0;

using Beams = std::vector<BreakBeamReading::Beam>;

// The beams of a gripper; none before they were measured.
const Beams& BeamsOf(const GripperInfo& gripper, std::span<const SensorReading> sensors) {
  static const Beams kNone;
  const BreakBeamReading* const reading = gripper.beams ? sensors[*gripper.beams].break_beams() : nullptr;
  return reading == nullptr ? kNone : reading->beams;
}

bool AnyBroken(const Beams& beams) {
  return std::any_of(beams.begin(), beams.end(), [](const auto& beam) { return beam.broken_by.has_value(); });
}

void SetOpening(GripperMachine& machine, double percent) {
  if (percent == 0.0) {
    machine.SetCommand(FingerCommand::kClose);
  } else if (percent == kPercent) {
    machine.SetCommand(FingerCommand::kOpen);
  } else {
    machine.SetOpening(percent / kPercent);
  }
}

// m or rad, of positions near 0.
constexpr double kPositionRounding = 1e-12;

// m, of an opening.
constexpr double kOpeningRounding = 1e-9;

bool IsOpen(const JointMotor& finger, const JointState& state) {
  return JointMotor::IsAt(state, finger.joint().position.min);
}

// The opening, m: the sum of both fingers.
double OpeningOf(const Fingers& f) {
  return f.left.joint().position.max - f.left_state.position + f.right.joint().position.max - f.right_state.position;
}

// The position of a finger that is open by `fraction`, m.
double PositionAt(const Interval& range, double fraction) {
  return range.Clamp(range.max - fraction * (range.max - range.min));
}

// From the present opening to that of `fraction`, m; negative: the fingers close.
double WayToOpening(const Fingers& f, double fraction) {
  const Interval& left = f.left.joint().position;
  const Interval& right = f.right.joint().position;
  return fraction * (left.max - left.min + right.max - right.min) - OpeningOf(f);
}

}  // namespace

Manipulator::Manipulator(const WorldDescription& world, RobotId robot) : world_(&world) {
  for (std::size_t i = 0; i < world.joints.size(); ++i) {
    if (world.joints[i].robot != robot) continue;
    ids_.emplace_back(i);
    joints_.push_back(&world.joints[i]);
    motors_.emplace_back(world.joints[i]);
  }
  finger_of_.resize(joints_.size());
  const auto number_of = [this](JointId id) {
    return static_cast<std::size_t>(std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin());
  };
  std::size_t next_sensor = world.robot(robot).sensors.size();
  for (std::size_t i = 0; i < world.grippers.size(); ++i) {
    const GripperDescription& gripper = world.grippers[i];
    if (gripper.robot != robot) continue;
    GripperInfo info{&gripper, number_of(gripper.left), number_of(gripper.right), {}, {}};
    if (!gripper.beams.empty()) info.beams = next_sensor++;  // as in MountedSensors
    if (gripper.lift) info.lift = number_of(*gripper.lift);
    finger_of_[info.left] = finger_of_[info.right] = grippers_.size();
    gripper_ids_.emplace_back(i);
    grippers_.push_back(info);
    machines_.emplace_back(gripper.autosnatch);
  }
  joint_readings_.resize(joints_.size());
  gripper_readings_.resize(grippers_.size());
}

void Manipulator::Update(const WorldState& state, std::span<const SensorReading> sensors) {
  for (std::size_t i = 0; i < grippers_.size(); ++i) {
    const Beams& beams = BeamsOf(grippers_[i], sensors);
    machines_[i].UpdateBeams(AnyBroken(beams), state.grippers[gripper_ids_[i].index()]);
    gripper_readings_[i] = Read(i, state);
    for (const auto& [beam, object] : beams) {
      gripper_readings_[i].beams.push_back(object ? std::optional(Seen(*object)) : std::nullopt);
    }
  }
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const JointState& joint = StateOf(i, state);
    joint_readings_[i] = {joint.position, joint.velocity, joint.blocked, motors_[i].moving(joint)};
  }
}

GripperReading Manipulator::Read(std::size_t number, const WorldState& state) {
  const GripperInfo& info = grippers_[number];
  const GripperState& gripper = state.grippers[gripper_ids_[number].index()];
  GripperReading reading;
  reading.fingers = machines_[number].Report(FingersOf(number, state));
  if (info.lift) {
    const JointState& lift = StateOf(*info.lift, state);
    const Interval& range = joints_[*info.lift]->position;
    reading.lift_moving = motors_[*info.lift].moving(lift);
    reading.lift_position = lift.position;
    if (range.max > range.min) reading.lift_percent = kPercent * (lift.position - range.min) / (range.max - range.min);
  }
  if (gripper.left_contact) reading.left_contact = Seen(*gripper.left_contact);
  if (gripper.right_contact) reading.right_contact = Seen(*gripper.right_contact);
  if (gripper.clamped) {
    reading.clamped = Seen(*gripper.clamped);
    if (state.objects[gripper.clamped->index()].holder == gripper_ids_[number]) reading.held = reading.clamped;
  }
  return reading;
}

Fingers Manipulator::FingersOf(std::size_t gripper, const WorldState& state) {
  const GripperInfo& info = grippers_[gripper];
  return {motors_[info.left], motors_[info.right], StateOf(info.left, state), StateOf(info.right, state),
          state.grippers[gripper_ids_[gripper].index()]};
}

Status Manipulator::Apply(const Command& command) {
  for (const GripperCommand& gripper : command.grippers) {
    if (Status status = Apply(gripper); !status.ok()) return status;
  }
  for (const JointCommand& joint : command.joints) {
    if (Status status = Apply(joint); !status.ok()) return status;
  }
  return {};
}

Status Manipulator::Apply(const GripperCommand& command) {
  if (command.gripper >= grippers_.size()) {
    return Error{{}, fmt::format("commands gripper {}, but the robot has {}", command.gripper, grippers_.size())};
  }
  const GripperInfo& info = grippers_[command.gripper];
  if (command.fingers && command.opening) {
    return Error{{},
                 fmt::format("commands gripper '{}' both to an opening and with another finger command, expected one",
                             info.description->name)};
  }
  if (command.fingers) machines_[command.gripper].SetCommand(*command.fingers);
  if (command.opening && !(*command.opening >= 0.0 && *command.opening <= kPercent)) {
    return Error{{},
                 fmt::format("commands gripper '{}' to an opening of {} percent, expected 0 to 100",
                             info.description->name, *command.opening)};
  }
  if (command.opening) SetOpening(machines_[command.gripper], *command.opening);
  if (!command.lift) return {};
  if (!info.lift)
    return Error{{}, fmt::format("commands the lift of gripper '{}', which has none", info.description->name)};
  if (!(*command.lift >= 0.0 && *command.lift <= kPercent)) {
    return Error{{},
                 fmt::format("commands gripper '{}' to a height of {} percent, expected 0 to 100",
                             info.description->name, *command.lift)};
  }
  const Interval& range = joints_[*info.lift]->position;
  motors_[*info.lift].MoveTo(range.Clamp(*command.lift / kPercent * (range.max - range.min) + range.min));
  return {};
}

Status Manipulator::Apply(const JointCommand& command) {
  if (command.joint >= joints_.size()) {
    return Error{{}, fmt::format("commands joint {}, but the robot has {}", command.joint, joints_.size())};
  }
  const JointDescription& joint = *joints_[command.joint];
  if (const std::optional<std::size_t>& gripper = finger_of_[command.joint]) {
    return Error{{},
                 fmt::format("commands joint '{}', a finger of gripper '{}', expected a command to the gripper",
                             joint.name, grippers_[*gripper].description->name)};
  }
  if (command.position.has_value() == command.velocity.has_value()) {
    return Error{
        {},
        fmt::format("commands joint '{}' to both or neither of a position and a velocity, expected one", joint.name)};
  }
  if (command.velocity) {
    if (!std::isfinite(*command.velocity)) {
      return Error{{}, fmt::format("commands joint '{}' to a velocity of {}", joint.name, *command.velocity)};
    }
    motors_[command.joint].MoveAt(*command.velocity);
    return {};
  }
  if (!(*command.position >= joint.position.min && *command.position <= joint.position.max)) {
    return Error{{},
                 fmt::format("commands joint '{}' to {}, expected {} to {}", joint.name, *command.position,
                             joint.position.min, joint.position.max)};
  }
  motors_[command.joint].MoveTo(*command.position);
  return {};
}

std::vector<double> Manipulator::Propose(const WorldState& state) {
  const double seconds = world_->interval_seconds();
  std::vector<double> velocities(joints_.size(), 0.0);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (!finger_of_[i]) velocities[i] = motors_[i].Velocity(StateOf(i, state), seconds);
  }
  for (std::size_t i = 0; i < grippers_.size(); ++i) {
    const GripperMachine::Velocities fingers = machines_[i].Propose(FingersOf(i, state), seconds);
    velocities[grippers_[i].left] = fingers.left;
    velocities[grippers_[i].right] = fingers.right;
  }
  // An empty list means the same, and is what most robots send.
  if (std::all_of(velocities.begin(), velocities.end(), [](double v) { return v == 0.0; })) velocities.clear();
  return velocities;
}

void JointMotor::MoveTo(double position) {
  target_ = position;
  speed_ = joint_->max_speed;
}

void JointMotor::MoveAt(double velocity) {
  target_.reset();
  // A velocity holds up to the limit of the joint; at 0 the joint stays without a target.
  if (velocity != 0.0) target_ = velocity > 0.0 ? joint_->position.max : joint_->position.min;
  speed_ = std::min(std::abs(velocity), joint_->max_speed);
}

double JointMotor::Velocity(const JointState& state, double tick_seconds) {
  const bool to_limit = target_ == joint_->position.min || target_ == joint_->position.max;
  // The limits stop a joint exactly.
  const double way = to_limit ? *target_ - state.position : RemainingWay(state);
  if (way == 0.0) {
    proposed_ = 0.0;
  } else if (to_limit || std::abs(way) >= speed_ * tick_seconds) {
    proposed_ = way > 0.0 ? speed_ : -speed_;
  } else {
    // The rest of the way in this one tick: it stops at the target and not behind it.
    proposed_ = way / tick_seconds;
  }
  return proposed_;
}

bool JointMotor::moving(const JointState& state) const {
  const double way = RemainingWay(state);
  // A contact ends a motion only in the direction that was proposed; the way back is free.
  const bool is_blocked = state.blocked && proposed_ * way > 0.0;
  return way != 0.0 && speed_ > 0.0 && !is_blocked;
}

double JointMotor::RemainingWay(const JointState& state) const {
  return !target_ || IsAt(state, *target_) ? 0.0 : *target_ - state.position;
}

bool JointMotor::IsAt(const JointState& state, double position) {
  return std::abs(position - state.position) <= kPositionRounding * std::max(1.0, std::abs(position));
}

void GripperMachine::SetCommand(FingerCommand command) {
  command_ = command;
  opening_.reset();
  commanded_ = true;
}

void GripperMachine::SetOpening(double fraction) {
  command_.reset();
  opening_ = fraction;
  commanded_ = true;
}

void GripperMachine::UpdateBeams(bool is_broken, const GripperState& gripper) {
  if (!autosnatch_) return;
  const FingerCommand own = is_broken ? FingerCommand::kClose : FingerCommand::kOpen;
  // A command of the robot holds until the beams ask for the same; from then on they decide again.
  if (commanded_ && command_ != own) return;
  commanded_ = false;
  // What is clamped need not be where the beams are: that they see nothing does not let it go.
  if (own == FingerCommand::kOpen && gripper.clamped) return;
  command_ = own;
}

FingerState GripperMachine::Report(const Fingers& f) const {
  const bool open = IsOpen(f.left, f.left_state) && IsOpen(f.right, f.right_state);
  if (command_ == FingerCommand::kOpen) return open ? FingerState::kOpen : FingerState::kOpening;
  if (command_ == FingerCommand::kStay || (!command_ && !opening_)) {
    return open ? FingerState::kOpen : FingerState::kClosed;
  }
  const bool done = f.gripper.clamped || !(f.left.moving(f.left_state) || f.right.moving(f.right_state));
  if (opening_ && !done && WayToOpening(f, *opening_) > 0.0) return FingerState::kOpening;
  return done ? FingerState::kClosed : FingerState::kClosing;
}

GripperMachine::Velocities GripperMachine::Propose(const Fingers& f, double tick_seconds) const {
  if (opening_) return ProposeOpening(f, *opening_, tick_seconds);
  // With an object between the pads the fingers stay: closing further would be a contact in each tick.
  const bool clamped = command_ == FingerCommand::kClose && f.gripper.clamped;
  if (!command_ || command_ == FingerCommand::kStay || clamped) {
    f.left.MoveAt(0.0);
    f.right.MoveAt(0.0);
  } else if (command_ == FingerCommand::kOpen) {
    f.left.MoveTo(f.left.joint().position.min);
    f.right.MoveTo(f.right.joint().position.min);
  } else {
    // Also while a contact blocks them: they continue when it ends.
    f.left.MoveTo(f.left.joint().position.max);
    f.right.MoveTo(f.right.joint().position.max);
  }
  return {f.left.Velocity(f.left_state, tick_seconds), f.right.Velocity(f.right_state, tick_seconds)};
}

GripperMachine::Velocities GripperMachine::ProposeOpening(const Fingers& f, double fraction,
                                                          double tick_seconds) const {
  const double way = WayToOpening(f, fraction);
  if (f.gripper.clamped && way <= kOpeningRounding) {
    f.left.MoveAt(0.0);
    f.right.MoveAt(0.0);
  } else {
    // Both to the same opening, but neither against the direction of the other: with an object off the middle, one
    // finger would push it while the other releases it.
    const auto target = [&](const JointMotor& finger, const JointState& state) {
      const double place = PositionAt(finger.joint().position, fraction);
      return way > 0.0 ? std::min(place, state.position) : std::max(place, state.position);
    };
    f.left.MoveTo(target(f.left, f.left_state));
    f.right.MoveTo(target(f.right, f.right_state));
  }
  return {f.left.Velocity(f.left_state, tick_seconds), f.right.Velocity(f.right_state, tick_seconds)};
}

}  // namespace troupe
