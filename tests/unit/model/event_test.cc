#include "troupe/event.h"

#include <gtest/gtest.h>

namespace troupe {
namespace {

TEST(Event, HasANameForEveryType) {
  EXPECT_STREQ(ToString(EventType::kStallBegan), "stall_began");
  EXPECT_STREQ(ToString(EventType::kStallEnded), "stall_ended");
  EXPECT_STREQ(ToString(EventType::kJoined), "joined");
  EXPECT_STREQ(ToString(EventType::kLeft), "left");
  EXPECT_STREQ(ToString(EventType::kProposalRejected), "proposal_rejected");
  EXPECT_STREQ(ToString(static_cast<EventType>(200)), "unknown");
}

}  // namespace
}  // namespace troupe
