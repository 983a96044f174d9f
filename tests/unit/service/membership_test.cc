#include "world-service/service/membership.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/identity.h"
#include "tests/unit/service/coordinator_fixture.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Outcome = JoinDecision::Outcome;

class MembershipTest : public testing::Test {
 protected:
  JoinMessage JoinOf(AgentId agent, const std::vector<std::string>& robots) const {
    return {1, agent, kProtocolVersion, Hash(world_), "host", 7, robots};
  }
  JoinDecision Join(AgentId agent, const std::vector<std::string>& robots) {
    return members_.Join(JoinOf(agent, robots), {0, 1}, 0.0);
  }

  WorldDescription world_ = test::PlaneWorld(3);
  Membership members_{world_, 2.0};
};

TEST_F(MembershipTest, KnowsTheRobotsWithoutAgents) {
  EXPECT_THAT(members_.AbsentRobots(), ElementsAre(RobotId(0), RobotId(1), RobotId(2)));
  const JoinDecision decision = Join(5, {"r2", "r0"});
  ASSERT_EQ(decision.outcome, Outcome::kAdmitted);
  EXPECT_THAT(decision.member->robots, ElementsAre(RobotId(0), RobotId(2)));
  EXPECT_THAT(members_.AbsentRobots(), ElementsAre(RobotId(1)));
  Join(6, {"r1"});
  EXPECT_TRUE(members_.all_robots_present());
  members_.Lose(*members_.Find(5));
  EXPECT_THAT(members_.AbsentRobots(), ElementsAre(RobotId(0), RobotId(2)));
  members_.Restore(*members_.Find(5));
  EXPECT_THAT(members_.AbsentRobots(), IsEmpty());
}

TEST_F(MembershipTest, AReplacementOfAnAgentThatAnsweredBeforeAResetIsNotRefused) {
  const auto join = [&](AgentId agent, double now) {
    return members_.Join(JoinOf(agent, {"r0"}), {1, 6}, now).outcome;  // at tick 5, after a rewind
  };
  Join(1, {"r0"});
  members_.Find(1)->last_answered = {0, 100};
  EXPECT_EQ(join(2, 0.0), Outcome::kUndecided);
  EXPECT_EQ(join(2, 1.0), Outcome::kUndecided);
  members_.Find(1)->last_answered = {1, 7};
  EXPECT_EQ(join(2, 1.0), Outcome::kRefused);
}

TEST_F(MembershipTest, TheHostOfAPeerIsAPlainLine) {
  JoinMessage join = JoinOf(1, {"r0"});
  join.host = "a\x1b[2J\n" + std::string(1000, 'x');
  const JoinDecision decision = members_.Join(join, {0, 1}, 0.0);
  ASSERT_EQ(decision.outcome, Outcome::kAdmitted);
  EXPECT_EQ(decision.member->host.substr(0, 8), "a [2J xx");
  EXPECT_EQ(decision.member->host.size(), kLongestHost);
}

TEST_F(MembershipTest, RefusesInvalidJoins) {
  Join(1, {"r0"});
  const auto refusal = [&](const JoinMessage& join) {
    const JoinDecision decision = members_.Join(join, {0, 1}, 0.0);
    EXPECT_EQ(decision.outcome, Outcome::kRefused);
    return decision.reason;
  };
  EXPECT_THAT(refusal(JoinOf(2, {})), HasSubstr("names no robots"));
  EXPECT_THAT(refusal(JoinOf(2, {"x"})), HasSubstr("no robot \"x\""));
  EXPECT_THAT(refusal(JoinOf(2, {"r1", "r1"})), HasSubstr("\"r1\" twice"));
  JoinMessage join = JoinOf(2, {"r1"});
  join.protocol_version = kProtocolVersion + 1;
  EXPECT_THAT(refusal(join), HasSubstr("protocol version"));
  join = JoinOf(2, {"r1"});
  ++join.world_hash;
  EXPECT_THAT(refusal(join), HasSubstr("another world"));
  EXPECT_EQ(members_.present_members(), 1u);
}

TEST_F(MembershipTest, ALostAgentThatLosesOneRobotToAnotherLosesAllOfThem) {
  Join(1, {"r0", "r1"});
  members_.Lose(*members_.Find(1));
  EXPECT_EQ(Join(2, {"r1"}).outcome, Outcome::kAdmitted);
  EXPECT_EQ(members_.Find(1), nullptr);
  EXPECT_THAT(members_.AbsentRobots(), ElementsAre(RobotId(0), RobotId(2)));
}

TEST_F(MembershipTest, AnAgentMayRejoinForOtherRobots) {
  Join(1, {"r0", "r1"});
  members_.Lose(*members_.Find(1));
  EXPECT_EQ(Join(1, {"r2"}).outcome, Outcome::kAdmitted);
  EXPECT_THAT(members_.AbsentRobots(), ElementsAre(RobotId(0), RobotId(1)));
}

TEST_F(MembershipTest, RemembersTheWaitsOfAgentsThatAreForgotten) {
  Join(1, {"r0"}).member->times_last = 3;
  members_.Lose(*members_.Find(1));
  Join(2, {"r0"}).member->times_last = 4;
  EXPECT_EQ(members_.WaitsOfRobots()[0].times_last, 7u);
}

TEST_F(MembershipTest, AgentsThatJoinAndLeaveDoNotGrowTheMembership) {
  for (AgentId agent = 1; agent < 1000; ++agent) {
    ASSERT_EQ(Join(agent, {"r0"}).outcome, Outcome::kAdmitted);
    members_.Lose(*members_.Find(agent));
    if (agent > 1) {
      EXPECT_EQ(members_.Find(agent - 1), nullptr);
    }
  }
}

}  // namespace
}  // namespace troupe
