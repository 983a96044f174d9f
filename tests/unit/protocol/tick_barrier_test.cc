#include "transport/protocol/tick_barrier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(TickBarrier, IsCompleteWithoutMembers) {
  TickBarrier barrier;
  barrier.Open(1);
  EXPECT_TRUE(barrier.complete());
}

TEST(TickBarrier, IsCompleteWhenAllMembersHaveArrived) {
  TickBarrier barrier;
  barrier.AddMember(7);
  barrier.AddMember(3);
  barrier.Open(1);
  EXPECT_FALSE(barrier.complete());
  EXPECT_TRUE(barrier.Arrive(3));
  EXPECT_FALSE(barrier.complete());
  EXPECT_TRUE(barrier.Arrive(7));
  EXPECT_TRUE(barrier.complete());
}

TEST(TickBarrier, NamesTheMissingInIdOrder) {
  TickBarrier barrier;
  for (AgentId agent : {9u, 2u, 5u}) barrier.AddMember(agent);
  barrier.Open(1);
  EXPECT_THAT(barrier.Missing(), ElementsAre(2, 5, 9));
  barrier.Arrive(5);
  EXPECT_THAT(barrier.Missing(), ElementsAre(2, 9));
}

TEST(TickBarrier, CountsAMemberOnceForATick) {
  TickBarrier barrier;
  barrier.AddMember(1);
  barrier.AddMember(2);
  barrier.Open(1);
  EXPECT_TRUE(barrier.Arrive(1));
  EXPECT_FALSE(barrier.Arrive(1));
  EXPECT_THAT(barrier.Missing(), ElementsAre(2));
}

TEST(TickBarrier, IgnoresAgentsThatAreNoMembers) {
  TickBarrier barrier;
  barrier.AddMember(1);
  barrier.Open(1);
  EXPECT_FALSE(barrier.Arrive(2));
  barrier.RemoveMember(2);
  EXPECT_THAT(barrier.Missing(), ElementsAre(1));
}

TEST(TickBarrier, ForgetsAnswersWhenItOpensAgain) {
  TickBarrier barrier;
  barrier.AddMember(1);
  barrier.Open(1);
  barrier.Arrive(1);
  barrier.Open(2);
  EXPECT_EQ(barrier.tick(), 2u);
  EXPECT_THAT(barrier.Missing(), ElementsAre(1));
  EXPECT_TRUE(barrier.Arrive(1));
}

TEST(TickBarrier, WaitsForAMemberThatIsAddedWhileItIsOpen) {
  TickBarrier barrier;
  barrier.AddMember(1);
  barrier.Open(4);
  barrier.Arrive(1);
  barrier.AddMember(2);
  EXPECT_THAT(barrier.Missing(), ElementsAre(2));
  barrier.AddMember(1);  // has arrived, which does not change
  EXPECT_THAT(barrier.Missing(), ElementsAre(2));
}

TEST(TickBarrier, DoesNotWaitForAMemberThatWasRemoved) {
  TickBarrier barrier;
  barrier.AddMember(1);
  barrier.AddMember(2);
  barrier.Open(1);
  barrier.Arrive(2);
  barrier.RemoveMember(2);
  EXPECT_EQ(barrier.missing(), 1u);
  barrier.RemoveMember(1);
  EXPECT_TRUE(barrier.complete());
  EXPECT_THAT(barrier.Missing(), IsEmpty());
  EXPECT_EQ(barrier.members(), 0u);
}

}  // namespace
}  // namespace troupe
