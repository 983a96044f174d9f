#include "world-service/service/event_text.h"

#include <gtest/gtest.h>

#include "tests/unit/service/coordinator_fixture.h"

namespace troupe {
namespace {

TEST(EventText, SaysWhatHappenedToWhomAndWhen) {
  const WorldDescription world = test::PlaneWorld(2);
  EXPECT_EQ(EventText(world, {7, EventType::kStallBegan, RobotId(0), ModelId(1), ""}), "tick 7: r0 stalled at r1");
  EXPECT_EQ(EventText(world, {7, EventType::kStallBegan, RobotId(0), std::nullopt, ""}), "tick 7: r0 stalled");
  EXPECT_EQ(EventText(world, {8, EventType::kStallEnded, RobotId(0), std::nullopt, ""}),
            "tick 8: r0 moves freely again");
  EXPECT_EQ(EventText(world, {9, EventType::kLeft, RobotId(1), std::nullopt, "why"}),
            "tick 9: r1 has lost its agent (why)");
  EXPECT_EQ(EventText(world, {9, EventType::kProposalRejected, std::nullopt, std::nullopt, "why"}),
            "tick 9: proposal rejected (why)");
}

}  // namespace
}  // namespace troupe
