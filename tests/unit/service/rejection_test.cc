// Messages of a hostile or broken peer: their only effects are an event, and a robot that stands still.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/service/coordinator_fixture.h"

namespace troupe {
namespace {

using test::CoordinatorTest;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class RejectionTest : public CoordinatorTest {
 protected:
  void SetUp() override { MakeAndStart(2); }
  std::string OnlyDetail() {
    const std::vector<Event> events = coordinator->DrainEvents();
    EXPECT_THAT(events, SizeIs(1));
    return events.empty() ? "" : events[0].detail;
  }
};

TEST_F(RejectionTest, NumbersThatAreNotFinite) {
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const Tick before = tick();
    const double place = Travel(1);
    Propose(2, bad);
    EXPECT_THAT(Events(), ElementsAre("proposal_rejected r1"));
    Propose(1);
    EXPECT_EQ(tick(), before + 1);  // the barrier continues,
    EXPECT_EQ(Travel(1), place);    // and the robot stands still
    EXPECT_EQ(endpoint.frames.back().events.at(0).type, EventType::kProposalRejected);
  }
}

TEST_F(RejectionTest, TwistsOverTheLimits) {
  Propose(1);
  Propose(2, 10.5);
  EXPECT_EQ(tick(), 1u);
  EXPECT_EQ(Travel(1), 0.0);
  EXPECT_THAT(OnlyDetail(), HasSubstr("expected"));
  Propose(1);
  Propose(2, 9.5);
  EXPECT_NEAR(Travel(1), 0.95, 1e-12);
}

TEST_F(RejectionTest, AnotherRun) {
  ProposalMessage proposal = ProposalOf(1, 1.0);
  proposal.run = kRun + 1;
  coordinator->OnProposal(proposal, now);
  EXPECT_THAT(OnlyDetail(), HasSubstr("another run"));
  Propose(2);
  EXPECT_EQ(tick(), 0u);  // it does not count as an answer
}

TEST_F(RejectionTest, AnAgentThatNeverJoined) {
  coordinator->OnProposal({kRun, 99, 1, {{RobotId(0), {}}}, {}}, now);
  EXPECT_THAT(OnlyDetail(), HasSubstr("not joined"));
  Propose(2);
  EXPECT_EQ(tick(), 0u);
}

TEST_F(RejectionTest, AFutureTick) {
  coordinator->OnProposal(ProposalOf(1, 1.0, 17), now);
  EXPECT_THAT(OnlyDetail(), HasSubstr("tick 17, expected 1"));
  Propose(2);
  EXPECT_EQ(tick(), 0u);
}

TEST_F(RejectionTest, RobotsOfOtherAgents) {
  Propose(1, 1.0);
  coordinator->OnProposal({kRun, 2, 1, {{RobotId(0), {5.0, 0, 0}}, {RobotId(1), {2.0, 0, 0}}}, {}}, now);
  EXPECT_EQ(tick(), 1u);
  EXPECT_NEAR(Travel(0), 0.1, 1e-12);
  EXPECT_NEAR(Travel(1), 0.2, 1e-12);
  EXPECT_THAT(Events(), ElementsAre("proposal_rejected r0"));
}

TEST_F(RejectionTest, RobotsThatDoNotExist) {
  Propose(1);
  coordinator->OnProposal({kRun, 2, 1, {{RobotId(1), {2.0, 0, 0}}, {RobotId(4000000000), {1.0, 0, 0}}}, {}}, now);
  EXPECT_NEAR(Travel(1), 0.2, 1e-12);
  EXPECT_THAT(Events(), ElementsAre("proposal_rejected"));
}

TEST_F(RejectionTest, ARobotNamedTwice) {
  Propose(1);
  coordinator->OnProposal({kRun, 2, 1, {{RobotId(1), {2.0, 0, 0}}, {RobotId(1), {3.0, 0, 0}}}, {}}, now);
  EXPECT_NEAR(Travel(1), 0.2, 1e-12);
  EXPECT_THAT(Events(), ElementsAre("proposal_rejected r1"));
}

TEST_F(RejectionTest, ARobotLeftOut) {
  Propose(1);
  coordinator->OnProposal({kRun, 2, 1, {}, {}}, now);
  EXPECT_EQ(tick(), 1u);
  EXPECT_EQ(Travel(1), 0.0);
  EXPECT_THAT(Events(), ElementsAre("proposal_rejected r1"));
}

TEST_F(RejectionTest, AllOfAHostilePeerAreCountedAndFewReported) {
  for (int i = 0; i < 1000; ++i) coordinator->OnProposal({kRun, 99, 1, {}, {}}, now);
  EXPECT_THAT(coordinator->DrainEvents(), SizeIs(10));
  now += 1.1;
  coordinator->OnProposal({kRun, 99, 1, {}, {}}, now);
  const std::vector<Event> events = coordinator->DrainEvents();
  ASSERT_THAT(events, SizeIs(2));
  EXPECT_THAT(events[0].detail, HasSubstr("990 more"));
  EXPECT_EQ(coordinator->MakeSummary().rejected, 1001u);
  Propose(1);
  Propose(2);
  EXPECT_EQ(tick(), 1u);
  EXPECT_LE(endpoint.frames.back().events.size(), 12u);
}

TEST_F(RejectionTest, ReportsWithoutEndDoNotGrowTheService) {
  ProposalMessage proposal = ProposalOf(1, 0.0);
  proposal.reports.assign(100000, "again");
  coordinator->OnProposal(proposal, now);
  EXPECT_LE(coordinator->DrainNotices().size(), 100u);
}

TEST_F(RejectionTest, ProposalsBeforeTheStartAreIgnored) {
  Make(2);
  coordinator->OnProposal({kRun, 1, 1, {}, {}}, now);
  EXPECT_THAT(Events(), IsEmpty());
}

}  // namespace
}  // namespace troupe
