// Manipulator: all joints and grippers of one robot, between its controller and its proposals.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robot-agent/gripper/gripper_machine.h"
#include "troupe/controller.h"
#include "troupe/result.h"

namespace troupe {

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

  // Applies the commands to grippers and joints, in order, up to the first one that is not valid for the robot: the
  // error describes it as in "commands gripper 3, but the robot has 1".
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
