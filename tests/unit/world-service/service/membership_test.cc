#include "world-service/service/membership.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>

#include "common/base/identity.h"
#include "common/spatial/scene.h"
#include "tests/unit/world-service/service/coordinator_fixture.h"
#include "troupe/random.h"
#include "world-service/service/tick_inputs.h"

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

TEST_F(MembershipTest, ARefusalNamesAllRobotsThatHaveAnotherAgentThatLives) {
  Join(1, {"r0"});
  Join(2, {"r1"});
  Join(3, {"r2"});
  const auto join = [&](double now) { return members_.Join(JoinOf(4, {"r0", "r1", "r2"}), {0, 1}, now); };
  EXPECT_EQ(join(0.0).outcome, Outcome::kUndecided);
  for (const AgentId agent : {1, 2}) members_.Find(agent)->last_answered = {0, 2};
  EXPECT_EQ(join(0.1).outcome, Outcome::kUndecided) << "the agent of r2 may be dead";
  members_.Lose(*members_.Find(3));
  const JoinDecision refused = join(0.2);
  EXPECT_EQ(refused.outcome, Outcome::kRefused);
  EXPECT_THAT(refused.taken, ElementsAre("r0", "r1"));
  EXPECT_THAT(refused.reason, HasSubstr("robot \"r0\" has an agent already (host, pid 7)"));
  EXPECT_EQ(members_.Join(JoinOf(4, {"r2"}), {0, 1}, 0.3).outcome, Outcome::kAdmitted);
}

TEST_F(MembershipTest, TheHostOfAPeerIsAPlainLine) {
  JoinMessage join = JoinOf(1, {"r0"});
  join.host = "a\x1b[2J\n" + std::string(1000, 'x');
  const JoinDecision decision = members_.Join(join, {0, 1}, 0.0);
  ASSERT_EQ(decision.outcome, Outcome::kAdmitted);
  EXPECT_EQ(decision.member->host.substr(0, 8), "a [2J xx");
  EXPECT_EQ(decision.member->host.size(), kMaxHost);
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
  EXPECT_EQ(members_.RobotWaits()[0].times_last, 7u);
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

namespace troupe::test {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::SizeIs;

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
    world_.robots[0].sensors.push_back(
        {.name = "radio", .model = world_.robots[0].root, .parameters = RadioParameters{}});
    scene_.emplace(world_);
  }

  ProposalMessage Message(Tick tick) const {
    return {1, 1, tick, {{RobotId(0), {1.0, 0.0, 0.0}, {}}, {RobotId(1), {}, {0.5}}}, {}};
  }

  WorldDescription world_;
  std::optional<Scene> scene_;
  WorldState state_;
  Member member_;
};

TEST_F(ProposalCollectorTest, WholeProposalsEnterTheStep) {
  ProposalCollector collector(*scene_, Mode::kLockstep);
  EXPECT_TRUE(collector.Collect(member_, Message(1), state_).empty());
  const auto proposals = collector.ForStep(state_);
  ASSERT_EQ(proposals.size(), 2u);
  EXPECT_EQ(proposals[0], (Proposal{RobotId(0), {1.0, 0.0, 0.0}, {}}));
  EXPECT_EQ(proposals[1], (Proposal{RobotId(1), {}, {0.5}}));
  state_.tick = 1;
  EXPECT_TRUE(collector.ForStep(state_).empty());
}

TEST_F(ProposalCollectorTest, AMessageOfAllRobotsThatMayBeKeptIsNotCopied) {
  ProposalCollector collector(*scene_, Mode::kLockstep);
  for (const Tick tick : {Tick{1}, Tick{2}}) {
    state_.tick = tick - 1;
    const auto shared = std::make_shared<const ProposalMessage>(Message(tick));
    EXPECT_TRUE(collector.Collect(member_, *shared, state_, shared).empty());
    EXPECT_EQ(collector.ForStep(state_).data(), shared->proposals.data());
  }
}

TEST_F(ProposalCollectorTest, KeptAndCopiedMessagesEnterTheStepInTheOrderOfRobots) {
  Member first{member_};
  first.robots = {RobotId(0)};
  Member second{member_};
  second.id = 2;
  second.robots = {RobotId(1)};
  ProposalMessage of_first = Message(1);
  ProposalMessage of_second = Message(1);
  of_first.proposals.pop_back();
  of_second.proposals.erase(of_second.proposals.begin());
  ProposalCollector collector(*scene_, Mode::kLockstep);
  auto shared = std::make_shared<const ProposalMessage>(of_second);
  EXPECT_TRUE(collector.Collect(second, *shared, state_, shared).empty());
  EXPECT_TRUE(collector.Collect(first, of_first, state_).empty());
  shared.reset();
  const auto proposals = collector.ForStep(state_);
  EXPECT_THAT(proposals, ElementsAreArray(Message(1).proposals));
}

TEST_F(ProposalCollectorTest, ARefusedProposalOfAKeptMessageStaysOut) {
  ProposalMessage message = Message(1);
  message.proposals[1].joint_velocities = {0.5, 0.5};
  const auto shared = std::make_shared<const ProposalMessage>(message);
  ProposalCollector collector(*scene_, Mode::kLockstep);
  EXPECT_THAT(collector.Collect(member_, *shared, state_, shared), SizeIs(1));
  EXPECT_THAT(collector.ForStep(state_), ElementsAre(message.proposals[0]));
}

TEST_F(ProposalCollectorTest, RealtimeModeKeepsJointVelocitiesForOneTick) {
  ProposalCollector collector(*scene_, Mode::kRealtime);
  EXPECT_TRUE(collector.Collect(member_, Message(1), state_).empty());
  state_.tick = 1;
  ASSERT_EQ(collector.ForStep(state_).size(), 2u);
  EXPECT_EQ(collector.ForStep(state_)[1].joint_velocities, std::vector{0.5});
  state_.tick = 2;
  EXPECT_TRUE(collector.ForStep(state_).empty());
}

TEST_F(ProposalCollectorTest, RealtimeModeSendsARadioMessageOnce) {
  ProposalMessage message = Message(1);
  message.proposals[0].messages.push_back({0, {}, {1, 2}});
  ProposalCollector collector(*scene_, Mode::kRealtime);
  EXPECT_TRUE(collector.Collect(member_, message, state_).empty());
  EXPECT_EQ(collector.ForStep(state_)[0].messages.size(), 1u);
  state_.tick = 1;
  ASSERT_EQ(collector.ForStep(state_).size(), 2u);
  EXPECT_TRUE(collector.ForStep(state_)[0].messages.empty());
}

}  // namespace

}  // namespace troupe::test

namespace troupe {
namespace {

using ::testing::Ge;

constexpr double kDeadline = 10.0;

// The times of the resends until the deadline, in s after the frame. `answers`: of other agents, at these times.
std::vector<double> Resends(ResendTimer& timer, const std::vector<double>& answers = {}) {
  std::vector<double> resends;
  auto answer = answers.begin();
  timer.Start(0.0);
  while (timer.due() < kDeadline || answer != answers.end()) {
    if (answer != answers.end() && *answer <= timer.due()) {
      timer.Answered(*answer++);
    } else {
      resends.push_back(timer.due());
      timer.Resent(timer.due());
    }
  }
  return resends;
}

TEST(ResendTimerTest, IsFarMoreFrequentThanTheDeadline) {
  ResendTimer timer(kDeadline);
  EXPECT_THAT(Resends(timer).size(), Ge(99u));
}

TEST(ResendTimerTest, AnswersOfOthersCannotPostponeAResendForLong) {
  std::vector<double> answers;
  for (int i = 1; i < 1000; ++i) answers.push_back(0.01 * i);
  ResendTimer timer(kDeadline);
  EXPECT_THAT(Resends(timer, answers).size(), Ge(9u));
}

TEST(ResendTimerTest, WithoutADeadlineItWaitsUpToASecond) {
  ResendTimer timer(0.0);
  const std::vector<double> resends = Resends(timer);
  EXPECT_NEAR(resends.back() - resends[resends.size() - 2], ResendTimer::kMaxWait, 1e-9);
}

// Over a slow link: each answer arrives `delay` after the first frame, and each resend is answered once more. Returns
// the number of resends in the tick.
int ResendsOfSlowTick(ResendTimer& timer, double delay, int agents) {
  int resends = 0;
  timer.Start(0.0);
  for (; timer.due() < delay; ++resends) timer.Resent(timer.due());
  for (int i = 0; i < agents; ++i) timer.Answered(delay);
  for (int i = 0; i < resends * agents; ++i) timer.AnsweredTwice();
  return resends;
}

TEST(ResendTimerTest, NeedlessResendsBecomeRare) {
  ResendTimer timer(kDeadline);
  EXPECT_THAT(ResendsOfSlowTick(timer, 0.8, 20), Ge(8));  // nothing is learned yet
  for (int tick = 0; tick < 10; ++tick) ResendsOfSlowTick(timer, 0.8, 20);
  for (int tick = 0; tick < 10; ++tick) EXPECT_LE(ResendsOfSlowTick(timer, 0.8, 20), 2) << tick;
  // On a link that is fast again they are soon as frequent as before.
  for (int tick = 0; tick < 60; ++tick) ResendsOfSlowTick(timer, 0.001, 20);
  EXPECT_THAT(Resends(timer).size(), Ge(99u));
}

// The probability that an agent is lost in a tick, because all round trips within the deadline fail.
double ProbabilityOfLoss(const ResendTimer& timer, double loss) {
  ResendTimer copy = timer;
  const double failure = 1.0 - (1.0 - loss) * (1.0 - loss);
  return std::pow(failure, 1.0 + static_cast<double>(Resends(copy).size()));
}

TEST(ResendTimerTest, LossOfMessagesLosesNoAgent) {
  // The expected losses of a million ticks with a hundred agents.
  EXPECT_LT(1e8 * ProbabilityOfLoss(ResendTimer(kDeadline), 0.3), 1e-12);
  EXPECT_LT(1e8 * ProbabilityOfLoss(ResendTimer(kDeadline), 0.45), 1e-6);
}

class LossyRunTest : public test::CoordinatorTest {
 protected:
  static constexpr AgentId kAgents = 8;

  bool Arrives(double loss) { return RandomUniform({1, draws_++}) >= loss; }
  // Delivers the frames that were sent since the last call, and the answers to them.
  void Exchange(double loss) {
    for (; delivered_ < endpoint.frames.size(); ++delivered_) {
      const FrameMessage frame = endpoint.frames[delivered_];
      for (AgentId agent = 1; agent <= kAgents; ++agent) {
        if (Arrives(loss) && Arrives(loss)) {
          coordinator->OnProposal(ProposalOf(agent, 0.1, frame.state.tick + 1), now);
        }
      }
    }
  }

  std::size_t delivered_ = 0;
  std::uint64_t draws_ = 0;
};

TEST_F(LossyRunTest, NoAgentIsLostByTheLossOfMessages) {
  constexpr double kLoss = 0.4;
  MakeAndStart(kAgents);
  while (tick() < 2000) {
    Exchange(kLoss);
    if (delivered_ == endpoint.frames.size()) Wait(coordinator->NextPoll() - now);
    ASSERT_THAT(Events(), IsEmpty()) << "tick " << tick();
  }
  EXPECT_EQ(coordinator->present_agents(), kAgents);
}

}  // namespace
}  // namespace troupe
