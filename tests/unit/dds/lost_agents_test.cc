#include <gtest/gtest.h>

#include "transport/dds/transport/dds_service_endpoint.h"

namespace troupe::dds {
namespace {

constexpr AgentId kIds = 1'000'000;

TEST(LostAgents, ForgetsTheOldestOfTooMany) {
  LostAgents lost;
  const GuidPrefix participant{{1}};
  for (AgentId i = 0; i < LostAgents::kMost; ++i) EXPECT_EQ(lost.Add(kIds - i, participant), std::nullopt);
  EXPECT_EQ(lost.Add(kIds - 1, participant), std::nullopt) << "lost again, so it is the newest";
  EXPECT_EQ(lost.Add(1, participant), kIds);
  EXPECT_EQ(lost.Add(kIds, participant), kIds - 2);
  EXPECT_TRUE(lost.Contains(kIds - 1, participant));
  EXPECT_FALSE(lost.Contains(kIds - 2, participant));
  EXPECT_FALSE(lost.Contains(1, GuidPrefix{{2}})) << "another participant";
  lost.Remove(1);
  EXPECT_FALSE(lost.Contains(1, participant));
  EXPECT_EQ(lost.Add(2, participant), std::nullopt);
}

}  // namespace
}  // namespace troupe::dds
