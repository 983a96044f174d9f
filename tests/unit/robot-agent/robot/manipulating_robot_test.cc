// A robot with a gripper, alone in its agent, with a controller that a test writes.
#include <gtest/gtest.h>

#include "common/spatial/body_index.h"
#include "robot-agent/robot/robot.h"
#include "tests/support/gripper_world.h"
#include "tests/support/values.h"

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
    if (state_.robots.empty()) state_ = PlacedState(world_.world);
    robot_ = ValueOf(Robot::Create(*scene_, parts_.robot, {nullptr, AllowedPaths::All()}));
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

// A box is gripped, lifted over another one, set down on it, and left.
constexpr const char* kStack = R"({"at": 0, "gripper": "close"}, {"at": 2, "lift": 50}, {"at": 4, "vx": 0.5},
                                  {"at": 6, "lift": 5}, {"at": 8, "gripper": "open"}, {"at": 10, "vx": -0.5}, {"at": 11})";

class StackingRobotTest : public ManipulatingRobotTest, public testing::WithParamInterface<std::int64_t> {
 protected:
  StackingRobotTest() {
    below_ = world_.AddObject({1.35, 0.0, 0.0, 0.0});
    world_.world.interval_ns = GetParam() * 1'000'000;
    for (JointDescription& joint : world_.world.joints) joint.max_speed = 0.5;
    SetScript(kStack);
  }
  void RunUntil(double seconds) {
    while (static_cast<double>(state_.tick) * world_.world.interval_seconds() < seconds - 1e-9) Run(1);
  }
  void ExpectHeldInTheAir() {
    EXPECT_EQ(box().holder, parts_.gripper);
    EXPECT_NEAR(box().X_WO.z, 0.5, 1e-9);
  }
  void ExpectStacked() {
    EXPECT_EQ(box().mode, ObjectMode::kResting);
    EXPECT_EQ(box().support, world_.world.objects[below_.index()]);
    EXPECT_EQ(box().X_WO.z, 0.1);
    EXPECT_NEAR(box().X_WO.x, 1.35, 1e-9);
    EXPECT_EQ(box().X_WO.y, 0.0);
    EXPECT_EQ(state_.objects[below_.index()].X_WO, (Pose{1.35, 0.0, 0.0, 0.0}));
    EXPECT_NEAR(state_.robots[0].X_WR.x, 0.5, 1e-9);
    EXPECT_EQ(state_.joints[parts_.left.index()].position, 0.0);
  }

  ObjectId below_;
};

TEST_P(StackingRobotTest, PutsABoxOnAnother) {
  Make();
  RunUntil(2.0);
  EXPECT_EQ(box().holder, parts_.gripper);
  EXPECT_EQ(box().X_WO, (Pose{0.35, 0.0, 0.0, 0.0}));  // nothing jumps
  RunUntil(5.0);
  ExpectHeldInTheAir();
  EXPECT_NEAR(box().X_WO.x, 0.85, 1e-9);
  RunUntil(12.0);
  ExpectStacked();
}

TEST_P(StackingRobotTest, ARestartedAgentContinues) {
  Make();
  RunUntil(5.0);
  Make();
  RunUntil(6.0);
  ExpectHeldInTheAir();
  RunUntil(12.0);
  ExpectStacked();
}

TEST_P(StackingRobotTest, AnAgentWithAnotherControllerHoldsOn) {
  Make();
  RunUntil(5.0);
  world_.world.robots[0].controller = {"idle", "{}"};
  Make();
  RunUntil(7.0);
  ExpectHeldInTheAir();
  EXPECT_NEAR(box().X_WO.x, 0.85, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(LengthsOfTicks, StackingRobotTest, testing::Values(50, 100, 200),
                         [](const auto& length) { return std::to_string(length.param) + "ms"; });

TEST_F(ManipulatingRobotTest, APercentageOutOfRangeStopsTheRobotButDropsNothing) {
  world_.world.robots[0].controller = {TEST_LIBRARY_FOLDER "/libcontroller_bad_lift.so", "{}"};
  Make();
  Run(4);
  EXPECT_EQ(box().holder, parts_.gripper);
  EXPECT_GT(state_.robots[0].twist.vx, 0.0);
  EXPECT_EQ(robot_->failure(), "");
  Run(3);
  EXPECT_NE(
      robot_->failure().find("failed at tick 5: commands gripper 'gripper' to a height of 140 percent, expected 0 "
                             "to 100"),
      std::string::npos)
      << robot_->failure();
  EXPECT_EQ(state_.robots[0].twist.vx, 0.0);
  EXPECT_EQ(box().holder, parts_.gripper);
}

TEST_F(ManipulatingRobotTest, AutosnatchGripsAnObjectInABeamWithoutAController) {
  world_.world.grippers[0].autosnatch = true;
  Make();
  Run(5);
  EXPECT_EQ(box().holder, parts_.gripper);
}

}  // namespace
}  // namespace troupe::test
