#include "robot-agent/gripper/manipulator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/values.h"
#include "tests/unit/robot-agent/gripper/hand.h"

namespace troupe::test {
namespace {

class ManipulatorTest : public testing::Test {
 protected:
  ManipulatorTest() { Restart(); }
  void Restart() {
    manipulator_ = std::make_unique<Manipulator>(hand_.world, RobotId(0));
    manipulator_->Update(hand_.state, sensors_);
  }
  void Tick(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      hand_.Move(manipulator_->Propose(hand_.state));
      manipulator_->Update(hand_.state, sensors_);
    }
  }
  std::string Apply(const Command& command) { return MessageOf(manipulator_->Apply(command)); }
  const GripperReading& gripper() const { return manipulator_->gripper_readings().at(0); }
  const JointReading& joint(std::size_t i) const { return manipulator_->joint_readings().at(i); }
  static Command Lift(double percent) { return {.twist = {}, .grippers = {{.lift = percent}}, .joints = {}}; }
  static Command Joint(JointCommand command) { return {.twist = {}, .grippers = {}, .joints = {command}}; }

  Hand hand_;
  // The readings of the break beams of the only gripper.
  void Break(std::vector<std::optional<ObjectId>> broken_by) {
    BreakBeamReading reading;
    for (const std::optional<ObjectId>& object : broken_by) reading.beams.push_back({{}, object});
    sensors_[0].content = reading;
  }
  std::vector<SensorReading> sensors_{1};
  std::unique_ptr<Manipulator> manipulator_;
};

TEST_F(ManipulatorTest, DescribesJointsAndGrippersOfItsRobotOnly) {
  hand_.world.robots.emplace_back().name = "r1";
  hand_.world.robots.back().root = ModelId(6);
  hand_.world.joints[Hand::kArm].robot = RobotId(1);
  Restart();
  EXPECT_EQ(manipulator_->joints().size(), 3u);
  ASSERT_EQ(manipulator_->grippers().size(), 1u);
  const GripperInfo& info = manipulator_->grippers()[0];
  EXPECT_EQ(info.description->name, "lift");
  EXPECT_EQ(info.left, 1u);
  EXPECT_EQ(info.right, 2u);
  EXPECT_EQ(info.lift, 0u);
  const Manipulator other(hand_.world, RobotId(1));
  EXPECT_EQ(other.joints(), std::vector<const JointDescription*>{&hand_.world.joints[Hand::kArm]});
  EXPECT_TRUE(other.grippers().empty());
}

TEST_F(ManipulatorTest, RequestsNoMotionWithoutACommand) {
  EXPECT_TRUE(manipulator_->Propose(hand_.state).empty());
}

TEST_F(ManipulatorTest, MovesToAHeightInPercent) {
  EXPECT_EQ(Apply(Lift(40.0)), "");
  Tick();
  EXPECT_TRUE(gripper().lift_moving);
  Tick(20);
  EXPECT_FALSE(gripper().lift_moving);
  EXPECT_NEAR(gripper().lift_position, 0.65, 1e-12);  // 0.4 (1.25 - 0.25) + 0.25
  EXPECT_NEAR(gripper().lift_percent, 40.0, 1e-9);
  EXPECT_EQ(Apply(Lift(100.0)), "");
  Tick(40);
  EXPECT_EQ(gripper().lift_position, 1.25);
  EXPECT_EQ(gripper().lift_percent, 100.0);
  EXPECT_EQ(Apply(Lift(0.0)), "");
  Tick(40);
  EXPECT_EQ(gripper().lift_position, 0.25);
}

TEST_F(ManipulatorTest, AnOpeningInPercentEqualsTheWordsAtItsEnds) {
  const auto opening = [](double percent) {
    return Command{.twist = {}, .grippers = {{.opening = percent}}, .joints = {}};
  };
  EXPECT_EQ(Apply(opening(0.0)), "");
  Tick(12);
  EXPECT_EQ(gripper().fingers, FingerState::kClosed);
  EXPECT_EQ(joint(Hand::kLeft).position, 0.5);
  EXPECT_EQ(Apply(opening(25.0)), "");
  Tick(12);
  EXPECT_NEAR(joint(Hand::kRight).position, 0.375, 1e-12);
  EXPECT_EQ(Apply(opening(100.0)), "");
  Tick(12);
  EXPECT_EQ(gripper().fingers, FingerState::kOpen);
  EXPECT_EQ(joint(Hand::kLeft).position, 0.0);
  EXPECT_EQ(Apply(opening(100.5)), "commands gripper 'lift' to an opening of 100.5 percent, expected 0 to 100");
  EXPECT_NE(Apply(opening(std::nan(""))), "");
  EXPECT_NE(Apply({.twist = {}, .grippers = {{.fingers = FingerCommand::kOpen, .opening = 1.0}}, .joints = {}}), "");
}

TEST_F(ManipulatorTest, APartWithoutAValueKeepsItsCommand) {
  EXPECT_EQ(Apply(Lift(40.0)), "");
  EXPECT_EQ(Apply({.twist = {}, .grippers = {{.fingers = FingerCommand::kClose}}, .joints = {}}), "");
  EXPECT_EQ(Apply({}), "");
  Tick(20);
  EXPECT_NEAR(gripper().lift_position, 0.65, 1e-12);
  EXPECT_EQ(gripper().fingers, FingerState::kClosed);
}

TEST_F(ManipulatorTest, JointsFollowPositionsAndVelocities) {
  EXPECT_EQ(Apply(Joint({.joint = Hand::kArm, .position = -1.1})), "");
  Tick();
  EXPECT_TRUE(joint(Hand::kArm).moving);
  EXPECT_NEAR(joint(Hand::kArm).velocity, -2.0, 1e-12);
  Tick(9);
  EXPECT_NEAR(joint(Hand::kArm).position, -1.1, 1e-12);
  EXPECT_FALSE(joint(Hand::kArm).moving);
  EXPECT_EQ(Apply(Joint({.joint = Hand::kArm, .velocity = 0.5})), "");
  Tick(2);
  EXPECT_NEAR(joint(Hand::kArm).position, -1.0, 1e-12);
}

TEST_F(ManipulatorTest, ALiftIsAJointToo) {
  EXPECT_EQ(Apply(Joint({.joint = Hand::kLift, .position = 0.5})), "");
  Tick(10);
  EXPECT_NEAR(gripper().lift_position, 0.5, 1e-12);
}

TEST_F(ManipulatorTest, ReportsContactsAndTheHeldObject) {
  hand_.state.grippers[0] = {ModelId(5), ModelId(6), std::nullopt};
  Restart();
  EXPECT_EQ(gripper().left_contact, (SeenModel{ModelId(5), "box"}));
  EXPECT_EQ(gripper().right_contact, (SeenModel{ModelId(6), "wall"}));
  EXPECT_FALSE(gripper().clamped);
  hand_.state.grippers[0].clamped = ObjectId(0);
  Restart();
  EXPECT_EQ(gripper().clamped, (SeenModel{ModelId(5), "box"}));
  EXPECT_FALSE(gripper().held);  // another gripper holds it
  hand_.state.objects[0].mode = ObjectMode::kHeld;
  hand_.state.objects[0].holder = GripperId(0);
  Restart();
  EXPECT_EQ(gripper().held, (SeenModel{ModelId(5), "box"}));
}

TEST_F(ManipulatorTest, ReportsTheObjectsInItsBeams) {
  EXPECT_TRUE(gripper().beams.empty());
  Break({std::nullopt, ObjectId(0)});
  Restart();
  ASSERT_EQ(gripper().beams.size(), 2u);
  EXPECT_FALSE(gripper().beams[0]);
  EXPECT_EQ(gripper().beams[1], (SeenModel{ModelId(5), "box"}));
}

TEST_F(ManipulatorTest, ABrokenBeamIsEnoughForAutosnatch) {
  hand_.world.grippers[0].autosnatch = true;
  Restart();
  Break({std::nullopt, ObjectId(0)});
  Tick(2);
  EXPECT_EQ(gripper().fingers, FingerState::kClosing);
}

TEST_F(ManipulatorTest, RefusesInvalidCommands) {
  const double nan = std::nan("");
  struct Case {
    Command command;
    const char* problem;
  };
  const Case cases[] = {
      {Lift(140.0), "commands gripper 'lift' to a height of 140 percent, expected 0 to 100"},
      {Lift(-1.0), "commands gripper 'lift' to a height of -1 percent, expected 0 to 100"},
      {Lift(nan), "commands gripper 'lift' to a height of nan percent, expected 0 to 100"},
      {{.twist = {}, .grippers = {{.gripper = 1}}, .joints = {}}, "commands gripper 1, but the robot has 1"},
      {Joint({.joint = 4, .position = 0.0}), "commands joint 4, but the robot has 4"},
      {Joint({.joint = Hand::kArm, .position = 2.5}), "commands joint 'arm' to 2.5, expected -2 to 2"},
      {Joint({.joint = Hand::kArm, .position = nan}), "commands joint 'arm' to nan, expected -2 to 2"},
      {Joint({.joint = Hand::kArm, .velocity = nan}), "commands joint 'arm' to a velocity of nan"},
      {Joint({.joint = Hand::kArm}),
       "commands joint 'arm' to both or neither of a position and a velocity, expected one"},
      {Joint({.joint = Hand::kArm, .position = 0.0, .velocity = 0.0}),
       "commands joint 'arm' to both or neither of a position and a velocity, expected one"},
      {Joint({.joint = Hand::kLeft, .position = 0.1}),
       "commands joint 'left', a finger of gripper 'lift', expected a command to the gripper"},
  };
  for (const Case& bad : cases) EXPECT_EQ(Apply(bad.command), bad.problem);
  hand_.world.grippers[0].lift.reset();
  Restart();
  EXPECT_EQ(Apply(Lift(50.0)), "commands the lift of gripper 'lift', which has none");
}

class JointMotorTest : public testing::Test {
 protected:
  void Tick() {
    std::vector<double> velocities(4, 0.0);
    velocities[Hand::kLift] = motor_.Velocity(state(), hand_.world.interval_seconds());
    hand_.Move(velocities);
  }
  const JointState& state() const { return hand_.state.joints[Hand::kLift]; }

  Hand hand_;  // the lift: 0.25 m to 1.25 m at 0.5 m/s
  JointMotor motor_{hand_.world.joints[Hand::kLift]};
};

TEST_F(JointMotorTest, StandsStillWithoutACommand) {
  EXPECT_EQ(motor_.Velocity(state(), 0.1), 0.0);
  EXPECT_FALSE(motor_.moving(state()));
}

TEST_F(JointMotorTest, ReachesATargetExactlyAtAnyLengthOfTicks) {
  for (std::int64_t interval_ns : {1'000'000, 33'333'333, 50'000'000, 100'000'000, 700'000'000}) {
    hand_.world.interval_ns = interval_ns;
    hand_.position(Hand::kLift) = 0.25;
    for (double target : {0.9, 0.3, 1.25, 0.7000001, 0.25}) {
      const double start = state().position;
      motor_.MoveTo(target);
      EXPECT_TRUE(motor_.moving(state()));
      int ticks = 0;
      while (motor_.moving(state())) {
        Tick();
        ASSERT_LE(++ticks, 10'000);
      }
      EXPECT_NEAR(state().position, target, 1e-12);
      Tick();  // for the last bit
      EXPECT_EQ(motor_.Velocity(state(), hand_.world.interval_seconds()), 0.0);
      // Half a metre in a second, up to the last tick.
      const double seconds = ticks * hand_.world.interval_seconds();
      EXPECT_NEAR(seconds, std::abs(target - start) / 0.5, hand_.world.interval_seconds() * 1.001) << interval_ns;
    }
    EXPECT_EQ(state().position, 0.25);  // the limit, to the last bit
  }
}

TEST_F(JointMotorTest, NeverExceedsItsSpeed) {
  motor_.MoveTo(1.0);
  for (int i = 0; i < 40; ++i) {
    EXPECT_LE(std::abs(motor_.Velocity(state(), 0.1)), 0.5);
    Tick();
  }
  motor_.MoveAt(-7.0);
  EXPECT_EQ(motor_.Velocity(state(), 0.1), -0.5);
}

TEST_F(JointMotorTest, AVelocityContinuesToTheLimit) {
  motor_.MoveAt(0.3);
  for (int i = 0; i < 10; ++i) Tick();
  EXPECT_NEAR(state().position, 0.55, 1e-12);
  EXPECT_TRUE(motor_.moving(state()));
  for (int i = 0; i < 30; ++i) Tick();
  EXPECT_EQ(state().position, 1.25);
  EXPECT_FALSE(motor_.moving(state()));
  motor_.MoveAt(-0.3);
  Tick();
  EXPECT_NEAR(state().position, 1.22, 1e-12);
  motor_.MoveAt(0.0);
  Tick();
  EXPECT_NEAR(state().position, 1.22, 1e-12);
}

TEST_F(JointMotorTest, ReportsABlockingContactButKeepsProposing) {
  hand_.stops[Hand::kLift] = 0.52;
  motor_.MoveTo(1.0);
  for (int i = 0; i < 10; ++i) Tick();
  EXPECT_EQ(state().position, 0.52);
  EXPECT_FALSE(motor_.moving(state()));
  motor_.MoveTo(0.3);  // the contact of the last motion does not block the motion back
  EXPECT_TRUE(motor_.moving(state()));
  motor_.MoveTo(1.0);
  hand_.stops[Hand::kLift] = 2.0;
  for (int i = 0; i < 11; ++i) Tick();
  EXPECT_NEAR(state().position, 1.0, 1e-12);
}

TEST_F(JointMotorTest, AJointWithoutSpeedIsNotMoving) {
  hand_.world.joints[Hand::kLift].max_speed = 0.0;
  motor_.MoveTo(1.0);
  EXPECT_EQ(motor_.Velocity(state(), 0.1), 0.0);
  EXPECT_FALSE(motor_.moving(state()));
}

}  // namespace
}  // namespace troupe::test
