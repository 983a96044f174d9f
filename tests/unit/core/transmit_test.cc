// The radio messages of steps and edits.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "common/model/states.h"
#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"
#include "world-service/core/edit_world.h"
#include "world-service/core/step.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

class TransmitTest : public testing::Test {
 protected:
  TransmitTest() : a_(world_.AddRobot("a", {})), b_(world_.AddRobot("b", {4.0, 0.0, 0.0, 0.0})) {
    test::AddSensor(world_.world(), a_, {}, RadioParameters{.bandwidth = 100.0});
    test::AddSensor(world_.world(), a_, {}, RadioParameters{.bandwidth = 100.0, .delay = 0.2});
    test::AddSensor(world_.world(), b_, {}, RadioParameters{});
    scene_ = std::make_shared<const Scene>(world_.world());
  }
  static Proposal Send(RobotId robot, std::vector<RadioMessage> messages) {
    Proposal proposal{robot, {}};
    proposal.messages = std::move(messages);
    return proposal;
  }

  SmallWorld world_;
  RobotId a_;
  RobotId b_;
  std::shared_ptr<const Scene> scene_;
};

TEST_F(TransmitTest, AMessageIsInTheStatesFromItsTickToItsArrival) {
  const WorldState start = InitialState(*scene_);
  WorldState state = Step(*scene_, start, {{Send(a_, {{0, b_, {1}}, {1, {}, {2, 3}}})}}).state;
  ASSERT_EQ(state.transmissions.size(), 2u);
  EXPECT_EQ(state.transmissions[0], (RadioTransmission{a_, 1, 1, 0, {0, b_, {1}}}));
  EXPECT_EQ(state.transmissions[1], (RadioTransmission{a_, 1, 3, 1, {1, std::nullopt, {2, 3}}}));
  EXPECT_TRUE(CheckState(scene_->world(), state).ok());
  state = Step(*scene_, state, {{Send(b_, {{0, {}, {}}})}}).state;
  ASSERT_EQ(state.transmissions.size(), 2u);
  EXPECT_EQ(state.transmissions[0].due, 3u);
  EXPECT_EQ(state.transmissions[1], (RadioTransmission{b_, 2, 2, 0, {0, std::nullopt, {}}}));
  state = Step(*scene_, state, {}).state;
  EXPECT_EQ(state.transmissions.size(), 1u);
  EXPECT_TRUE(Step(*scene_, state, {}).state.transmissions.empty());
}

TEST_F(TransmitTest, EveryPartOfAMessageChangesTheHash) {
  WorldState state = Step(*scene_, InitialState(*scene_), {{Send(a_, {{0, b_, {1, 2}}})}}).state;
  const std::uint64_t hash = StateHash(state);
  const auto changes = [&](auto change) {
    WorldState other = state;
    change(other.transmissions[0]);
    return StateHash(other) != hash;
  };
  EXPECT_TRUE(changes([&](RadioTransmission& t) { t.from = b_; }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { ++t.sent; }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { ++t.due; }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { ++t.number; }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { t.message.radio = 1; }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { t.message.to.reset(); }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { t.message.bytes[1] = 3; }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { t.message.bytes.pop_back(); }));
}

TEST_F(TransmitTest, ProposalsBeyondTheRadiosAreRefused) {
  const WorldState state = InitialState(*scene_);
  const auto problem = [&](std::vector<RadioMessage> messages) {
    const Status status = ValidateProposal(scene_->world(), state, Send(a_, std::move(messages)));
    return status.ok() ? "" : status.error().message;
  };
  EXPECT_EQ(problem({{0, b_, std::vector<std::uint8_t>(10)}, {1, {}, std::vector<std::uint8_t>(10)}}), "");
  EXPECT_EQ(problem({{0, b_, std::vector<std::uint8_t>(11)}}),
            "found a radio message of 11 bytes beyond the bandwidth of 'radio:0', expected at most 10 bytes in a tick");
  EXPECT_NE(problem({{0, b_, std::vector<std::uint8_t>(6)}, {0, b_, std::vector<std::uint8_t>(6)}}), "");
  EXPECT_EQ(problem({{2, {}, {}}}), "found a message of sensor 2, expected a radio of the robot");
  EXPECT_EQ(problem({{0, RobotId(2), {}}}), "found a radio message to robot 2, expected one of 2 robots");
  EXPECT_NE(problem(std::vector<RadioMessage>(kMostRadioMessages + 1, {0, {}, {}})), "");
}

TEST_F(TransmitTest, ADeletedRobotTakesItsMessagesAlong) {
  const WorldState state =
      Step(*scene_, InitialState(*scene_), {{Send(a_, {{1, {}, {1}}}), Send(b_, {{0, {}, {2}}, {0, a_, {3}}})}}).state;
  ASSERT_EQ(state.transmissions.size(), 3u);
  const Result<EditedWorld> edited = DeleteEntity(scene_, state, "a");
  ASSERT_TRUE(edited.ok());
  ASSERT_EQ(edited.value().state.transmissions.size(), 1u);
  EXPECT_EQ(edited.value().state.transmissions[0].message.bytes.front(), 2);
  EXPECT_TRUE(CheckState(edited.value().scene->world(), edited.value().state).ok());
}

TEST_F(TransmitTest, AResetOfTimeEndsAllMessages) {
  const WorldState state = Step(*scene_, InitialState(*scene_), {{Send(a_, {{1, {}, {1}}})}}).state;
  EXPECT_TRUE(ResetWorld(scene_, scene_, state, {.time = true, .state = false, .spawned = false, .deleted = false})
                  .state.transmissions.empty());
}

}  // namespace
}  // namespace troupe
