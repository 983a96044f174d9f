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
  if (std::all_of(velocities.begin(), velocities.end(), [](double v) { return v == 0.0; })) velocities.clear();
  return velocities;
}

}  // namespace troupe
