#include "world-service/core/step.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "common/base/check.h"
#include "common/spatial/sweep.h"
#include "world-service/core/gravity.h"
#include "world-service/core/grip.h"
#include "world-service/core/motion.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

// The proposal of each robot, by id; null for a robot without one.
std::vector<const Proposal*> ProposalByRobot(std::size_t robots, std::span<const Proposal> proposals) {
  std::vector<const Proposal*> by_robot(robots, nullptr);
  for (std::size_t i = 0; i < proposals.size(); ++i) {
    TROUPE_CHECK(proposals[i].robot.index() < robots);
    TROUPE_CHECK(i == 0 || proposals[i - 1].robot < proposals[i].robot);
    by_robot[proposals[i].robot.index()] = &proposals[i];
  }
  return by_robot;
}

// One robot's turn.
class RobotTurn {
 public:
  // `proposal` may be null.
  RobotTurn(StepWorkspace& workspace, RobotId robot, const Proposal* proposal)
      : workspace_(workspace), robot_(robot), proposal_(proposal) {}

  void Act() {
    for (GripperId gripper : workspace_.scene.grippers_of(robot_)) {
      const GripperDescription& description = workspace_.world().gripper(gripper);
      if (VelocityOf(description.left) < 0.0 || VelocityOf(description.right) < 0.0) Release(workspace_, gripper);
    }
    ActBase();
    for (JointId joint : workspace_.scene.joints_of(robot_)) ActJoint(joint);
    for (GripperId gripper : workspace_.scene.grippers_of(robot_)) {
      const GripperDescription& description = workspace_.world().gripper(gripper);
      Grip(workspace_, gripper, FingerOf(description.left), FingerOf(description.right));
    }
  }

 private:
  double VelocityOf(JointId joint) const {
    if (proposal_ == nullptr || proposal_->joint_velocities.empty()) return 0.0;
    return proposal_->joint_velocities[NumberOf(joint)];
  }
  // The joint's place among the robot's.
  std::size_t NumberOf(JointId joint) const {
    const std::span<const JointId> joints = workspace_.scene.joints_of(robot_);
    return static_cast<std::size_t>(std::lower_bound(joints.begin(), joints.end(), joint) - joints.begin());
  }
  FingerMotion FingerOf(JointId joint) const { return {VelocityOf(joint), joint_contacts_[NumberOf(joint)]}; }

  void ActBase() {
    RobotState& robot = workspace_.next.robots[robot_.index()];
    const bool was_stalled = robot.stalled;
    std::optional<Contact> contact;
    if (proposal_ == nullptr || proposal_->twist.IsZero()) {
      robot.twist = {};
      if (proposal_ != nullptr) robot.stalled = false;  // a robot that is to stand is not stalled
    } else {
      contact = MoveBase(workspace_, robot_, proposal_->twist);
      if (contact) workspace_.Touch(contact->other);
    }
    if (robot.stalled == was_stalled) return;
    workspace_.robot_events.push_back({.tick = workspace_.next.tick,
                                       .type = robot.stalled ? EventType::kStallBegan : EventType::kStallEnded,
                                       .robot = robot_,
                                       .other = robot.stalled ? contact->other : std::nullopt});
  }

  void ActJoint(JointId id) {
    const bool was_blocked = workspace_.next.joints[id.index()].blocked;
    const std::optional<Contact> contact = MoveJoint(workspace_, id, VelocityOf(id));
    joint_contacts_.push_back(contact);
    if (!contact) return;
    workspace_.Touch(contact->other);
    if (was_blocked || IsGrip(id, *contact)) return;
    workspace_.robot_events.push_back({.tick = workspace_.next.tick,
                                       .type = EventType::kBlocked,
                                       .robot = robot_,
                                       .other = contact->other,
                                       .detail = workspace_.world().joint(id).name});
  }

  // The contact of a pad with an object is part of gripping it, not a blocked joint.
  bool IsGrip(JointId joint, const Contact& contact) const {
    if (!contact.other || !workspace_.scene.object_of(*contact.other)) return false;
    for (GripperId id : workspace_.scene.grippers_of(robot_)) {
      const GripperDescription& gripper = workspace_.world().gripper(id);
      if ((joint == gripper.left && contact.mine == gripper.left_pad) ||
          (joint == gripper.right && contact.mine == gripper.right_pad)) {
        return true;
      }
    }
    return false;
  }

  StepWorkspace& workspace_;
  const RobotId robot_;
  const Proposal* const proposal_;
  std::vector<std::optional<Contact>> joint_contacts_;  // by the robot's joints
};

}  // namespace

StepResult Step(const Scene& scene, const WorldState& state, std::span<const Proposal> proposals) {
  BodyIndex bodies(scene);
  return Step(scene, state, proposals, bodies);
}

StepResult Step(const Scene& scene, const WorldState& state, std::span<const Proposal> proposals, BodyIndex& bodies) {
  const std::size_t count = state.robots.size();
  TROUPE_CHECK(count == scene.world().robots.size());
  const std::vector<const Proposal*> by_robot = ProposalByRobot(count, proposals);

  StepWorkspace workspace(scene, state, std::move(bodies));
  workspace.next.tick = state.tick + 1;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = (workspace.next.tick + k) % count;  // so that no robot is always first
    RobotTurn(workspace, RobotId(i), by_robot[i]).Act();
  }
  DropLostObjects(workspace);
  LetObjectsFall(workspace);

  bodies = std::move(workspace.bodies);
  StepResult result{std::move(workspace.next), std::move(workspace.robot_events)};
  std::stable_sort(result.events.begin(), result.events.end(),
                   [](const Event& a, const Event& b) { return a.robot < b.robot; });
  std::move(workspace.object_events.begin(), workspace.object_events.end(), std::back_inserter(result.events));
  return result;
}

}  // namespace troupe
