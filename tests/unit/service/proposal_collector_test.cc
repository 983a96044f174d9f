#include <gtest/gtest.h>

#include "tests/unit/service/coordinator_fixture.h"
#include "world-service/service/tick_inputs.h"

namespace troupe::test {
namespace {

class ProposalCollectorTest : public testing::Test {
 protected:
  ProposalCollectorTest() : world_(PlaneWorld(2)) {
    // r1 gets a part that turns.
    world_.models.push_back(world_.models.back());
    world_.models.back().name = "r1.mast";
    world_.models.back().parent = world_.robots[1].root;
    world_.joints.push_back(JointDescription{.name = "mast",
                                             .robot = RobotId(1),
                                             .model = ModelId(world_.models.size() - 1),
                                             .type = JointType::kRevolute,
                                             .position = {-1.0, 1.0}});
    state_ = PlacedState(world_);
    member_.id = 1;
    member_.robots = {RobotId(0), RobotId(1)};
  }

  ProposalMessage Message(Tick tick) const {
    return {1, 1, tick, {{RobotId(0), {1.0, 0.0, 0.0}, {}}, {RobotId(1), {}, {0.5}}}, {}};
  }

  WorldDescription world_;
  WorldState state_;
  Member member_;
};

TEST_F(ProposalCollectorTest, WholeProposalsEnterTheStep) {
  ProposalCollector collector(world_, Mode::kLockstep);
  EXPECT_TRUE(collector.Collect(member_, Message(1), state_).empty());
  const auto proposals = collector.ForStep(state_);
  ASSERT_EQ(proposals.size(), 2u);
  EXPECT_EQ(proposals[0], (Proposal{RobotId(0), {1.0, 0.0, 0.0}, {}}));
  EXPECT_EQ(proposals[1], (Proposal{RobotId(1), {}, {0.5}}));
  state_.tick = 1;
  EXPECT_TRUE(collector.ForStep(state_).empty());
}

TEST_F(ProposalCollectorTest, RealtimeModeKeepsJointVelocitiesForOneTick) {
  ProposalCollector collector(world_, Mode::kRealtime);
  EXPECT_TRUE(collector.Collect(member_, Message(1), state_).empty());
  state_.tick = 1;
  ASSERT_EQ(collector.ForStep(state_).size(), 2u);
  EXPECT_EQ(collector.ForStep(state_)[1].joint_velocities, std::vector{0.5});
  state_.tick = 2;
  EXPECT_TRUE(collector.ForStep(state_).empty());
}

TEST_F(ProposalCollectorTest, RealtimeModeSendsARadioMessageOnce) {
  world_.robots[0].sensors.push_back(
      {.name = "radio", .model = world_.robots[0].root, .parameters = RadioParameters{}});
  ProposalMessage message = Message(1);
  message.proposals[0].messages.push_back({0, {}, {1, 2}});
  ProposalCollector collector(world_, Mode::kRealtime);
  EXPECT_TRUE(collector.Collect(member_, message, state_).empty());
  EXPECT_EQ(collector.ForStep(state_)[0].messages.size(), 1u);
  state_.tick = 1;
  ASSERT_EQ(collector.ForStep(state_).size(), 2u);
  EXPECT_TRUE(collector.ForStep(state_)[0].messages.empty());
}

}  // namespace
}  // namespace troupe::test
