// Manipulator: all joints and grippers of one robot, between its controller and its proposals. It turns commands
// ("open", "lift to 40 percent") into joint velocities for one tick, and the state into readings.
//
// The progress of a motion is in the world's state, never here: what is kept are the last commands. So a robot that
// joins again, or is continued from a snapshot, drops no object and moves on. JointMotor reaches its target exactly;
// GripperMachine decides what the two fingers do; Manipulator has one of each for every joint and gripper, by the
// numbers of RobotInfo.
//
// A command that is not valid for the robot is an error of its controller, and none of its parts from there on is
// applied.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "troupe/controller.h"
#include "troupe/result.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

class JointMotor {
 public:
  // The description must outlive the motor. Without a command the joint does not move.
  explicit JointMotor(const JointDescription& joint) : joint_(&joint) {}

  const JointDescription& joint() const { return *joint_; }

  // Commands a position, m or rad. REQUIRES: it is within the joint's limits.
  void MoveTo(double position);
  // Commands a velocity, m/s or rad/s, up to the joint's limit; bounded by the speed of the joint.
  void MoveAt(double velocity);

  // The velocity (m/s or rad/s) to propose for the next tick. The time of a motion does not depend on the length of
  // ticks, and the joint reaches its target exactly.
  double Velocity(const JointState& state, double tick_seconds);

  // True if the joint is at `position` (m or rad) up to rounding.
  static bool IsAt(const JointState& state, double position);
  // True if the joint has not reached its target and no contact blocks it.
  bool moving(const JointState& state) const;

 private:
  // From the joint's position to its target, m or rad; 0 at the target up to rounding.
  double RemainingWay(const JointState& state) const;

  const JointDescription* joint_;
  std::optional<double> target_;  // m or rad
  double speed_ = 0.0;            // m/s or rad/s
  double proposed_ = 0.0;         // the last proposal, m/s or rad/s
};

// The fingers' motors and the states of the gripper and its fingers.
struct Fingers {
  JointMotor& left;
  JointMotor& right;
  const JointState& left_state;
  const JointState& right_state;
  const GripperState& gripper;
};

// GripperMachine: the state machine of the two fingers of a gripper. Its states are open, closing, closed, opening;
// they follow from the state of the world and the last command, so that a restarted agent continues and drops no
// object. JointMotor: moves one joint to its commanded position, tick by tick.
class GripperMachine {
 public:
  // With autosnatch the fingers close when a beam is broken, and open when none is and no object is between the pads.
  explicit GripperMachine(bool autosnatch) : autosnatch_(autosnatch) {}

  bool autosnatch() const { return autosnatch_; }

  // A command is valid until the next one. With autosnatch, it is valid until the beams demand the same: fingers with
  // the command to open stay open until the object has left the beams.
  void SetCommand(FingerCommand command);
  // Commands an opening, as a fraction of the widest one. REQUIRES: 0 < fraction < 1
  void SetOpening(double fraction);
  // Applies the state of the break beams. With autosnatch, call it before the others in each tick.
  void UpdateBeams(bool is_broken, const GripperState& gripper);

  FingerState Report(const Fingers& fingers) const;

  struct Velocities {
    double left = 0.0;  // m/s, for the next tick
    double right = 0.0;
  };
  Velocities Propose(const Fingers& fingers, double tick_seconds) const;

 private:
  Velocities ProposeOpening(const Fingers& fingers, double fraction, double tick_seconds) const;

  bool autosnatch_;
  std::optional<FingerCommand> command_;  // nothing, and no opening_: the fingers stay
  std::optional<double> opening_;         // as in SetOpening; excludes command_
  bool commanded_ = false;                // by a controller, and the beams have not demanded the same since
};

class Manipulator {
 public:
  // The world must outlive the manipulator.
  Manipulator(const WorldDescription& world, RobotId robot);

  // Continues in an edited world with the same ids and descriptions of the robot. REQUIRES: the first world still
  // exists.
  void ChangeWorld(const WorldDescription& world) { world_ = &world; }

  const std::vector<const JointDescription*>& joints() const { return joints_; }
  const std::vector<GripperInfo>& grippers() const { return grippers_; }

  // Applies the state that the controller decides on, with the readings of the robot's sensors, by sensor.
  void Update(const WorldState& state, std::span<const SensorReading> sensors);
  // As the controller sees them, until the next Update.
  const std::vector<JointReading>& joint_readings() const { return joint_readings_; }
  const std::vector<GripperReading>& gripper_readings() const { return gripper_readings_; }

  // Applies the commands to grippers and joints, in order, up to the first one that is not valid for the robot. The
  // error
  // describes it: "commands gripper 3, but the robot has 1".
  Status Apply(const Command& command);

  // The joint velocities to propose after `state`, as in Proposal. REQUIRES: `state` is that of the last Update.
  std::vector<double> Propose(const WorldState& state);

 private:
  Status Apply(const GripperCommand& command);
  Status Apply(const JointCommand& command);
  Fingers FingersOf(std::size_t gripper, const WorldState& state);
  const JointState& StateOf(std::size_t joint, const WorldState& state) const {
    return state.joints[ids_[joint].index()];
  }
  SeenModel Seen(ModelId model) const { return {model, world_->model(model).name}; }
  SeenModel Seen(ObjectId object) const { return Seen(world_->objects[object.index()]); }
  GripperReading Read(std::size_t gripper, const WorldState& state);

  const WorldDescription* world_;
  std::vector<JointId> ids_;  // of the robot's joints
  std::vector<const JointDescription*> joints_;
  std::vector<JointMotor> motors_;                     // by joint
  std::vector<std::optional<std::size_t>> finger_of_;  // by joint: the gripper whose finger it is
  std::vector<GripperId> gripper_ids_;
  std::vector<GripperInfo> grippers_;
  std::vector<GripperMachine> machines_;  // by gripper
  std::vector<JointReading> joint_readings_;
  std::vector<GripperReading> gripper_readings_;
};

}  // namespace troupe
