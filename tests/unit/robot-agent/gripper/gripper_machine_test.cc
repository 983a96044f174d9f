#include <gtest/gtest.h>

#include <optional>

#include "robot-agent/gripper/manipulator.h"
#include "tests/unit/robot-agent/gripper/hand.h"

namespace troupe::test {
namespace {

class GripperMachineTest : public testing::Test {
 protected:
  GripperMachineTest() { Restart(); }

  // As in a restarted agent: only the state of the world remains.
  void Restart(bool autosnatch = false) {
    machine_.emplace(autosnatch);
    left_.emplace(hand_.world.joints[Hand::kLeft]);
    right_.emplace(hand_.world.joints[Hand::kRight]);
  }
  Fingers fingers() {
    return {*left_, *right_, hand_.state.joints[Hand::kLeft], hand_.state.joints[Hand::kRight], gripper()};
  }
  GripperState& gripper() { return hand_.state.grippers[0]; }
  FingerState state() { return machine_->Report(fingers()); }

  void Tick(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      machine_->UpdateBeams(beam_, gripper());
      const auto velocities = machine_->Propose(fingers(), hand_.world.interval_seconds());
      hand_.Move({0.0, velocities.left, velocities.right, 0.0});
      if (velocities.left < 0.0 || velocities.right < 0.0) gripper() = {};
    }
    machine_->UpdateBeams(beam_, gripper());
  }
  void Hold() { gripper() = {ModelId(5), ModelId(5), ObjectId(0)}; }

  Hand hand_;  // fingers: 0.5 m at 0.5 m/s
  bool beam_ = false;
  std::optional<GripperMachine> machine_;
  std::optional<JointMotor> left_;
  std::optional<JointMotor> right_;
};

TEST_F(GripperMachineTest, PassesThroughItsFourStates) {
  EXPECT_EQ(state(), FingerState::kOpen);
  machine_->SetCommand(FingerCommand::kClose);
  Tick();
  EXPECT_EQ(state(), FingerState::kClosing);
  EXPECT_NEAR(hand_.position(Hand::kLeft), 0.05, 1e-12);
  Tick(9);
  EXPECT_EQ(state(), FingerState::kClosed);
  EXPECT_NEAR(hand_.position(Hand::kRight), 0.5, 1e-12);
  machine_->SetCommand(FingerCommand::kOpen);
  Tick();
  EXPECT_EQ(state(), FingerState::kOpening);
  Tick(9);
  EXPECT_EQ(state(), FingerState::kOpen);
  Tick();
  EXPECT_EQ(hand_.position(Hand::kLeft), 0.0);  // to the last bit
}

TEST_F(GripperMachineTest, ReversesInTheMiddle) {
  machine_->SetCommand(FingerCommand::kClose);
  Tick(3);
  machine_->SetCommand(FingerCommand::kOpen);
  Tick();
  EXPECT_EQ(state(), FingerState::kOpening);
  EXPECT_NEAR(hand_.position(Hand::kLeft), 0.1, 1e-12);
}

TEST_F(GripperMachineTest, StopsPushingWhenItHasAnObject) {
  machine_->SetCommand(FingerCommand::kClose);
  Tick(3);
  Hold();
  EXPECT_EQ(state(), FingerState::kClosed);
  Tick(3);
  EXPECT_NEAR(hand_.position(Hand::kLeft), 0.15, 1e-12);
}

TEST_F(GripperMachineTest, ReachesAnOpeningFromBothSides) {
  machine_->SetOpening(0.7);
  Tick();
  EXPECT_EQ(state(), FingerState::kClosing);
  Tick(4);
  EXPECT_EQ(state(), FingerState::kClosed);  // not fully open
  EXPECT_NEAR(hand_.position(Hand::kLeft), 0.15, 1e-12);
  machine_->SetOpening(0.9);
  Tick();
  EXPECT_EQ(state(), FingerState::kOpening);
  Tick(4);
  EXPECT_NEAR(hand_.position(Hand::kLeft), 0.05, 1e-12);
  EXPECT_NEAR(hand_.position(Hand::kRight), 0.05, 1e-12);
}

TEST_F(GripperMachineTest, HoldsAnObjectWiderThanTheRequestedOpening) {
  machine_->SetOpening(0.2);
  Tick(2);
  Hold();
  Tick(3);
  EXPECT_EQ(state(), FingerState::kClosed);
  EXPECT_NEAR(hand_.position(Hand::kLeft), 0.1, 1e-12);
  machine_->SetOpening(0.9);
  Tick(4);
  EXPECT_NEAR(hand_.position(Hand::kLeft), 0.05, 1e-12);
  EXPECT_FALSE(gripper().clamped);
}

TEST_F(GripperMachineTest, NoFingerClosesWhileTheyOpen) {
  hand_.position(Hand::kLeft) = 0.1;
  hand_.position(Hand::kRight) = 0.3;
  Hold();
  machine_->SetOpening(0.7);  // 0.15 m each, were it for the middle
  Tick(2);
  EXPECT_EQ(hand_.position(Hand::kLeft), 0.1);
  EXPECT_NEAR(hand_.position(Hand::kRight), 0.2, 1e-12);
}

TEST_F(GripperMachineTest, StaysOnCommand) {
  machine_->SetCommand(FingerCommand::kClose);
  Tick(2);
  machine_->SetCommand(FingerCommand::kStay);
  Tick(2);
  EXPECT_EQ(state(), FingerState::kClosed);
  EXPECT_NEAR(hand_.position(Hand::kLeft), 0.1, 1e-12);
  Hold();
  Tick(2);
  EXPECT_TRUE(gripper().clamped);
}

TEST_F(GripperMachineTest, OneFingerWaitsForTheOther) {
  hand_.stops[Hand::kLeft] = 0.1;
  machine_->SetCommand(FingerCommand::kClose);
  Tick(4);
  EXPECT_EQ(state(), FingerState::kClosing);
  EXPECT_EQ(hand_.position(Hand::kLeft), 0.1);
  EXPECT_NEAR(hand_.position(Hand::kRight), 0.2, 1e-12);
  Tick(6);
  EXPECT_EQ(state(), FingerState::kClosed);  // on nothing: one finger is stopped, one is at its limit
}

TEST_F(GripperMachineTest, ClosesFurtherWhenABlockingContactEnds) {
  hand_.stops[Hand::kLeft] = hand_.stops[Hand::kRight] = 0.1;
  machine_->SetCommand(FingerCommand::kClose);
  Tick(4);
  EXPECT_EQ(state(), FingerState::kClosed);
  hand_.stops[Hand::kLeft] = hand_.stops[Hand::kRight] = 1.0;
  Tick(1);
  EXPECT_EQ(state(), FingerState::kClosing);
  Tick(9);
  EXPECT_EQ(hand_.position(Hand::kLeft), 0.5);
}

TEST_F(GripperMachineTest, ARestartedAgentKeepsTheObjectOfItsRobot) {
  machine_->SetCommand(FingerCommand::kClose);
  Tick(3);
  Hold();
  const WorldState before = hand_.state;
  Restart();
  EXPECT_EQ(state(), FingerState::kClosed);
  Tick(5);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(hand_.position(i), before.joints[i].position);
  EXPECT_EQ(hand_.state.grippers, before.grippers);
}

TEST_F(GripperMachineTest, ARestartedAgentLeavesHalfOpenFingersInPlace) {
  machine_->SetCommand(FingerCommand::kClose);
  Tick(3);
  Restart();
  EXPECT_EQ(state(), FingerState::kClosed);
  Tick(3);
  EXPECT_NEAR(hand_.position(Hand::kLeft), 0.15, 1e-12);
}

TEST_F(GripperMachineTest, AutosnatchClosesOnABrokenBeamAndOpensWithoutOne) {
  Restart(true);
  Tick();
  EXPECT_EQ(state(), FingerState::kOpen);
  beam_ = true;
  Tick(2);
  EXPECT_EQ(state(), FingerState::kClosing);
  beam_ = false;
  Tick();
  EXPECT_EQ(state(), FingerState::kOpening);
}

TEST_F(GripperMachineTest, AutosnatchDoesNotDropAnObjectOutsideTheBeams) {
  Restart(true);
  beam_ = true;
  Tick(3);
  Hold();
  beam_ = false;
  Tick(3);
  EXPECT_EQ(state(), FingerState::kClosed);
  EXPECT_TRUE(gripper().clamped);
}

TEST_F(GripperMachineTest, AutosnatchObeysOpenUntilTheObjectIsGone) {
  Restart(true);
  beam_ = true;
  Tick(3);
  Hold();
  machine_->SetCommand(FingerCommand::kOpen);
  Tick(3);
  EXPECT_EQ(state(), FingerState::kOpen);
  EXPECT_FALSE(gripper().clamped);
  Tick(3);
  EXPECT_EQ(state(), FingerState::kOpen);  // the object still breaks a beam
  beam_ = false;
  Tick();
  beam_ = true;
  Tick();
  EXPECT_EQ(state(), FingerState::kClosing);
}

TEST_F(GripperMachineTest, AutosnatchObeysCloseUntilABeamWasBroken) {
  Restart(true);
  machine_->SetCommand(FingerCommand::kClose);
  Tick(12);
  EXPECT_EQ(state(), FingerState::kClosed);
  beam_ = true;
  Tick();
  beam_ = false;
  Tick();
  EXPECT_EQ(state(), FingerState::kOpening);
}

TEST_F(GripperMachineTest, WithoutAutosnatchBeamsMoveNothing) {
  beam_ = true;
  Tick(3);
  EXPECT_EQ(hand_.position(Hand::kLeft), 0.0);
}

}  // namespace
}  // namespace troupe::test
