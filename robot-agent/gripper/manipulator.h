// Manipulator: all joints and grippers of one robot, between its controller and its proposals.
#pragma once

#include <string>
#include <vector>

#include "robot-agent/controller/controller.h"
#include "robot-agent/gripper/gripper_machine.h"
#include "robot-agent/gripper/joint_motor.h"

namespace troupe {

class Manipulator {
 public:
  // The world must outlive the manipulator.
  Manipulator(const WorldDescription& world, RobotId robot);

  // An edit has changed the world, and left the robot as it was. The first one must still be there.
  void ChangeWorld(const WorldDescription& world) { world_ = &world; }

  const std::vector<const JointDescription*>& joints() const { return joints_; }
  const std::vector<GripperInfo>& grippers() const { return grippers_; }

  // Takes in the state that the controller decides on, with what breaks each gripper's beams: by gripper and beam.
  void Sense(const WorldState& state, const std::vector<std::vector<std::optional<ObjectId>>>& beams);
  // What it looks like to the controller, until the next Sense.
  const std::vector<JointReading>& joint_readings() const { return joint_readings_; }
  const std::vector<GripperReading>& gripper_readings() const { return gripper_readings_; }

  // Takes over what a controller asks of joints and grippers; "" or what is wrong with it.
  std::string Take(const Command& command);

  // What to propose after the sensed `state`, as in Proposal.
  std::vector<double> Propose(const WorldState& state);

 private:
  std::string TakeGripper(const GripperCommand& command);
  std::string TakeJoint(const JointCommand& command);
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
