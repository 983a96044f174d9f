// A robot with a gripper, alone in its agent, with a controller that a test writes.
#include <gtest/gtest.h>

#include <functional>

#include "common/spatial/body_index.h"
#include "robot-agent/agent/robot.h"
#include "tests/support/gripper_world.h"

namespace troupe::test {
namespace {

class ManipulatingRobotTest : public testing::Test {
 protected:
  ManipulatingRobotTest() : parts_(world_.AddGripperRobot({})) {
    box_ = world_.AddObject({0.35, 0.0, 0.0, 0.0});
    world_.world.grippers[0].beams = {{{0.1, 0.15}, {0.1, -0.15}, 0.05}};
  }
  void SetScript(const std::string& commands) {
    world_.world.robots[0].controller = {"script", R"({"commands": [)" + commands + "]}"};
  }
  void Make() {
    scene_ = std::make_unique<Scene>(world_.world);
    bodies_ = std::make_unique<BodyIndex>(*scene_);
    if (state_.robots.empty()) state_ = InitialState(world_.world);
    Result<std::unique_ptr<Robot>> robot = Robot::Create(*scene_, parts_.robot, nullptr);
    ASSERT_TRUE(robot.ok()) << robot.error().message;
    robot_ = std::move(robot).value();
  }
  Proposal Decide() {
    bodies_->Assign(state_);
    return robot_->Decide(state_, *bodies_);
  }
  // Ticks of robot and world together.
  void Run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      const Proposal proposal = Decide();
      StepResult result = Step(*scene_, state_, std::span(&proposal, 1));
      state_ = std::move(result.state);
    }
  }
  const ObjectState& box() const { return state_.objects[box_.index()]; }

  GripperWorld world_;
  GripperRobot parts_;
  ObjectId box_;
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<BodyIndex> bodies_;
  std::unique_ptr<Robot> robot_;
  WorldState state_;
};

TEST_F(ManipulatingRobotTest, ARobotThatWantsNothingProposesNoJointMotion) {
  Make();
  EXPECT_TRUE(Decide().joint_velocities.empty());
}

TEST_F(ManipulatingRobotTest, AutosnatchTakesWhatBreaksABeamWithoutAController) {
  world_.world.grippers[0].autosnatch = true;
  Make();
  Run(5);
  EXPECT_EQ(box().holder, parts_.gripper);
}

}  // namespace
}  // namespace troupe::test
