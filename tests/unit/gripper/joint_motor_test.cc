#include <gtest/gtest.h>

#include "robot-agent/gripper/manipulator.h"
#include "tests/unit/gripper/hand.h"

namespace troupe::test {
namespace {

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
