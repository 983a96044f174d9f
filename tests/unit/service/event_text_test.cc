#include <gtest/gtest.h>

#include "tests/unit/service/coordinator_fixture.h"
#include "world-service/service/event_log.h"

namespace troupe {
namespace {

TEST(EventText, NamesTheEventItsParticipantsAndItsTick) {
  const WorldDescription world = test::PlaneWorld(2);
  EXPECT_EQ(EventText(world, {7, EventType::kStallBegan, RobotId(0), ModelId(1), ""}), "tick 7: r0 stalled at r1");
  EXPECT_EQ(EventText(world, {7, EventType::kStallBegan, RobotId(0), std::nullopt, ""}), "tick 7: r0 stalled");
  EXPECT_EQ(EventText(world, {8, EventType::kStallEnded, RobotId(0), std::nullopt, ""}),
            "tick 8: r0 moves freely again");
  EXPECT_EQ(EventText(world, {9, EventType::kLeft, RobotId(1), std::nullopt, "why"}),
            "tick 9: r1 has lost its agent (why)");
  EXPECT_EQ(EventText(world, {9, EventType::kProposalRejected, std::nullopt, std::nullopt, "why"}),
            "tick 9: proposal rejected (why)");
  const ModelId box(1);  // any model with a name serves for these texts
  EXPECT_EQ(EventText(world, {9, EventType::kBlocked, RobotId(0), ModelId(1), "lift", {}}),
            "tick 9: r0 is blocked by r1 (lift)");
  EXPECT_EQ(EventText(world, {9, EventType::kBlocked, RobotId(0), {}, "lift", {}}),
            "tick 9: r0 is blocked by the ground (lift)");
  EXPECT_EQ(EventText(world, {9, EventType::kGripped, RobotId(0), {}, "hand", box}), "tick 9: r0 holds r1 (hand)");
  EXPECT_EQ(EventText(world, {9, EventType::kReleased, RobotId(0), {}, "hand", box}), "tick 9: r0 released r1 (hand)");
  EXPECT_EQ(EventText(world, {9, EventType::kLanded, {}, {}, "", box}), "tick 9: r1 landed on the ground");
  EXPECT_EQ(EventText(world, {9, EventType::kUnstable, {}, ModelId(0), "", box}),
            "tick 9: r1 landed out of balance on r0");
}

}  // namespace
}  // namespace troupe
