// The agent's side of the tick protocol, on a time that only the test advances.
#include "robot-agent/agent/agent_protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "common/base/identity.h"
#include "tests/support/small_world.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

constexpr RunId kRun = 4;
constexpr AgentId kAgent = 7;

WorldDescription World() {
  SmallWorld world;
  world.SetController(world.AddRobot("r0", {}), "script", R"({"commands": [{"at": 0, "vx": 0.5}]})");
  world.AddRobot("r1", {2.0, 0.0, 0.0, 0.0});
  return world.world();
}

WorldDescription Without(const std::set<std::string>& robots) {
  WorldDescription world = World();
  for (ModelDescription& model : world.models) model.removed = robots.contains(model.name);
  return world;
}

class Proposals final : public AgentEndpoint {
 public:
  void Start(AgentHandler&) override {}
  void SendJoin(const JoinMessage&) override {}
  void SendProposal(const ProposalMessage& proposal) override { sent.push_back(proposal); }

  std::vector<ProposalMessage> sent;
};

class AgentProtocolTest : public testing::Test {
 protected:
  AgentProtocolTest() {
    options_.agent = kAgent;
    options_.session_timeout_seconds = 20.0;
  }

  void SendSession(Edition edition = 0, const WorldDescription& world = World(), RunId run = kRun) {
    protocol_.OnSession(
        SessionMessage{.run = run, .protocol_version = kProtocolVersion, .world = world, .world_edition = edition});
  }
  void Finish(ReplicaTask& task) {
    task.Perform(options_, {});
    protocol_.FinishTask(task);
  }
  void PerformTask() {
    ReplicaTask task = protocol_.BeginTask().value();
    Finish(task);
  }
  static FrameMessage Frame(Tick tick, Edition edition = 0) {
    FrameMessage frame{.run = kRun, .state = PlacedState(World())};
    frame.state.tick = tick;
    frame.edition = frame.world_edition = edition;
    return frame;
  }
  void SendFrame(Tick tick, Edition edition = 0) { protocol_.OnFrame(Frame(tick, edition), now_); }
  void Answer(bool admitted, const std::string& reason = {}) {
    protocol_.OnAdmission({kRun, kAgent, admitted, reason});
  }
  void RefuseFor(const std::vector<std::string>& taken) {
    protocol_.OnAdmission(
        {.run = kRun, .agent = kAgent, .reason = "robot has an agent already", .taken = taken, .incarnation = 0});
  }
  std::optional<JoinMessage> PollAfter(double seconds) {
    now_ += seconds;
    return protocol_.Poll(now_);
  }
  // The join that it sends at once.
  JoinMessage Joined() { return PollAfter(0.0).value(); }
  // Joins, and answers frame 0.
  void JoinAndRun() {
    SendSession();
    PerformTask();
    Joined();
    Answer(true);
    SendFrame(0);
    ASSERT_THAT(endpoint_.sent, SizeIs(1));
  }
  // The times of the joins in the next `seconds`, from now on.
  std::vector<double> Joins(double seconds) {
    std::vector<double> times;
    const double begin = now_;
    while (protocol_.NextPoll() <= begin + seconds) {
      now_ = std::max(now_, protocol_.NextPoll());
      if (protocol_.Poll(now_)) times.push_back(now_ - begin);
      if (protocol_.over()) break;
    }
    now_ = begin + seconds;
    return times;
  }

  AgentOptions options_;
  Proposals endpoint_;
  double now_ = 100.0;
  AgentProtocol protocol_{endpoint_, options_, {}, now_};
};

HistoryMessage HistoryOf(const std::optional<ControllerCheckpoint>& after, std::vector<HistoryEntry> entries,
                         const std::vector<AgentId>& agents = {kAgent}) {
  return {kRun, agents, after, std::move(entries)};
}

class HistoryTest : public AgentProtocolTest {
 protected:
  static HistoryEntry Entry(Tick tick, Edition edition = 0) {
    HistoryEntry entry{Frame(tick, edition), true, {}};
    entry.frame.world_edition = 0;
    return entry;
  }
  // The agent has made its replica, and sends its first join.
  void Prepare() {
    SendSession();
    PerformTask();
    const JoinMessage join = Joined();
    EXPECT_EQ(join.memory, std::nullopt);
  }
};

TEST_F(HistoryTest, TheRobotsProcessItAndTheAgentJoinsAgainAtOnce) {
  Prepare();
  protocol_.OnHistory(HistoryOf({}, {Entry(0), Entry(1), Entry(2)}));
  EXPECT_EQ(PollAfter(5.0), std::nullopt) << "it joins no more before it knows the history";
  PerformTask();
  JoinMessage join = Joined();
  EXPECT_EQ(join.memory, (ControllerCheckpoint{0, 2, true}));
  EXPECT_THAT(endpoint_.sent, IsEmpty());
  // The same again, what others need, and what does not follow, have no effect.
  protocol_.OnHistory(HistoryOf({}, {Entry(0)}));
  protocol_.OnHistory(HistoryOf(ControllerCheckpoint{0, 5, true}, {Entry(6)}));
  EXPECT_FALSE(protocol_.has_task());
  // An answer to another agent with the same memory is of use.
  protocol_.OnHistory(HistoryOf(ControllerCheckpoint{0, 2, true}, {Entry(3)}, {99}));
  PerformTask();
  join = Joined();
  EXPECT_EQ(join.memory, (ControllerCheckpoint{0, 3, true}));
  SendFrame(4);
  EXPECT_THAT(endpoint_.sent, IsEmpty());
  Answer(true);
  ASSERT_THAT(endpoint_.sent, SizeIs(1));
  EXPECT_EQ(endpoint_.sent[0].tick, 5u);
}

TEST_F(HistoryTest, OfNewRobotsOnlyTheOneThatWasAskedForIsOfUse) {
  Prepare();
  protocol_.OnHistory(HistoryOf({}, {Entry(0)}, {99}));
  EXPECT_FALSE(protocol_.has_task());
}

TEST_F(HistoryTest, AnOlderWorldIsFollowedByThatOfTheSession) {
  SendSession(3, Without({"r1"}));
  PerformTask();
  Joined();
  HistoryEntry first = Entry(0);
  first.world = World();
  protocol_.OnHistory(HistoryOf({}, {first, Entry(1)}));
  PerformTask();
  const JoinMessage join = Joined();
  EXPECT_EQ(join.world_edition, 3u);
  EXPECT_EQ(join.world_hash, Hash(Without({"r1"})));
  EXPECT_THAT(join.robots, ElementsAre("r0"));
  SendFrame(1, 3);
  Answer(true);
  PerformTask();  // the world of the session again
  ASSERT_THAT(endpoint_.sent, SizeIs(1));
  EXPECT_EQ(endpoint_.sent[0].edition, 3u);
  EXPECT_THAT(endpoint_.sent[0].proposals, SizeIs(1));
}

TEST_F(HistoryTest, AHistoryThatDoesNotFitItsWorldEndsTheAgent) {
  Prepare();
  HistoryEntry bad = Entry(0);
  bad.frame.state.robots.pop_back();
  protocol_.OnHistory(HistoryOf({}, {bad}));
  PerformTask();
  EXPECT_TRUE(protocol_.over());
  EXPECT_THAT(protocol_.failure().error().message, testing::HasSubstr("sent a bad history"));
}

// After a rewind the robots are made anew, and need the states since.
TEST_F(HistoryTest, AFrameOfARewoundRunIsAnsweredOnceItsHistoryIsKnown) {
  Prepare();
  Answer(true);
  SendFrame(9);
  ASSERT_THAT(endpoint_.sent, SizeIs(1));
  FrameMessage frame = Frame(4, 2);
  frame.world_edition = 0;
  frame.fresh_edition = 2;
  frame.remembered = true;
  protocol_.OnFrame(frame, now_);
  PerformTask();  // the robots are made anew
  ASSERT_THAT(endpoint_.sent, SizeIs(1)) << "it has no memory of ticks 0 to 3";
  JoinMessage join = Joined();
  EXPECT_EQ(join.memory, std::nullopt);
  HistoryEntry entry = Entry(3, 2);
  entry.frame.fresh_edition = 2;
  protocol_.OnHistory(HistoryOf({}, {entry}));
  PerformTask();
  Joined();
  Answer(true);
  ASSERT_THAT(endpoint_.sent, SizeIs(2));
  EXPECT_EQ(endpoint_.sent[1].edition, 2u);
  EXPECT_EQ(endpoint_.sent[1].tick, 5u);
}

TEST_F(AgentProtocolTest, JoinsLessAndLessOftenUntilTheRunHasBegun) {
  SendSession();
  PerformTask();
  EXPECT_THAT(Joins(13.0), SizeIs(9));  // 0, 0.1, 0.3, 0.7, ... 3.1, 6.3, 9.5, 12.7
  SendFrame(0);                         // the admission was lost
  EXPECT_THAT(Joins(1.0).size(), ::testing::Ge(9u));
}

TEST_F(AgentProtocolTest, ALostServiceIsJoinedAgainAndTheRobotsContinue) {
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  EXPECT_FALSE(protocol_.over());
  SendFrame(1);
  EXPECT_THAT(endpoint_.sent, SizeIs(1)) << "not a member";
  const JoinMessage join = Joined();
  EXPECT_EQ(join.agent, kAgent);
  EXPECT_EQ(join.world_hash, Hash(World()));
  EXPECT_THAT(join.robots, ElementsAre("r0", "r1"));
  Answer(true);
  ASSERT_THAT(endpoint_.sent, SizeIs(2));
  EXPECT_EQ(endpoint_.sent.back().tick, 2u);
  EXPECT_FALSE(protocol_.has_task()) << "the replica is kept";
}

TEST_F(AgentProtocolTest, AServiceThatReturnsIsJoinedAtOnce) {
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  Joins(5.03);
  SendSession();
  EXPECT_TRUE(PollAfter(0.0).has_value());
}

TEST_F(AgentProtocolTest, GivesUpALostServiceAfterTheSessionTimeout) {
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  Joins(19.9);
  EXPECT_FALSE(protocol_.over());
  Joins(0.2);
  ASSERT_TRUE(protocol_.over());
  EXPECT_EQ(protocol_.failure().error().message, "the world service is gone, and has not returned within 20 s");
  EXPECT_EQ(protocol_.failure().error().code, ErrorCode::kFailure);
}

TEST_F(AgentProtocolTest, TheEndOfTheServiceEndsAnAgentThatWaitsForIt) {
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  protocol_.OnServiceGone(now_);
  ASSERT_TRUE(protocol_.over());
  EXPECT_TRUE(protocol_.failure().ok());
}

TEST_F(AgentProtocolTest, TheLastFrameEndsAnAgentThatWaitsForTheService) {
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  FrameMessage last = Frame(9);
  last.last = true;
  protocol_.OnFrame(last, now_);
  EXPECT_TRUE(protocol_.over());
  EXPECT_TRUE(protocol_.failure().ok());
}

TEST_F(AgentProtocolTest, AnotherRunDoesNotReplaceALostService) {
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  SendSession(0, World(), kRun + 1);
  EXPECT_FALSE(protocol_.has_task());
  EXPECT_EQ(PollAfter(0.0)->run, kRun);
}

TEST_F(AgentProtocolTest, AnAgentThatIsUnknownJoinsAgain) {
  JoinAndRun();
  Answer(false);
  Joined();
  Answer(false);  // a duplicate
  EXPECT_FALSE(protocol_.over());
  Answer(true);
  SendFrame(1);
  EXPECT_THAT(endpoint_.sent, SizeIs(2));
}

TEST_F(AgentProtocolTest, ALateRefusalOfAnEarlierJoinDoesNotEndAMember) {
  JoinAndRun();
  Answer(false, "the robot has an agent already");
  SendFrame(1);
  EXPECT_THAT(endpoint_.sent, SizeIs(2));
}

TEST_F(AgentProtocolTest, JoinsForTheWorldThatWasEditedMeanwhileAndFollowsTheEditOnceAdmitted) {
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  SendSession(2, Without({"r1"}));
  const JoinMessage join = Joined();
  EXPECT_EQ(join.world_edition, 2u);
  EXPECT_EQ(join.world_hash, Hash(Without({"r1"})));
  EXPECT_THAT(join.robots, ElementsAre("r0"));
  SendFrame(3, 2);
  Answer(true);
  PerformTask();
  ASSERT_THAT(endpoint_.sent, SizeIs(2));
  EXPECT_EQ(endpoint_.sent.back().edition, 2u);
  EXPECT_THAT(endpoint_.sent.back().proposals, SizeIs(1));
}

TEST_F(AgentProtocolTest, FollowsALoadOfAWorldWithOtherIdsThatCameBeforeItsFirstAnswer) {
  SmallWorld other;
  other.AddRobot("new", {});
  other.AddRobot("r1", {1.0, 0.0, 0.0, 0.0});
  other.AddRobot("r0", {2.0, 0.0, 0.0, 0.0});
  SendSession();
  PerformTask();
  PollAfter(0.0);
  Answer(true);
  protocol_.OnServiceLost(now_);
  SendSession(1, other.world());
  Joined();
  Answer(true);
  FrameMessage frame = Frame(0, 1);
  frame.state = PlacedState(other.world());
  frame.fresh_edition = 1;
  protocol_.OnFrame(frame, now_);
  PerformTask();
  ASSERT_THAT(endpoint_.sent, SizeIs(1));
  EXPECT_THAT(endpoint_.sent[0].proposals, ElementsAre(Proposal{RobotId(1), {}}, Proposal{RobotId(2), {}}));
}

TEST_F(AgentProtocolTest, AMessageFromBeforeTheLossDoesNotMeanThatTheServiceHasReturned) {
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  Answer(true);
  SendFrame(1);
  Joins(19.9);
  EXPECT_FALSE(protocol_.over());
  Joins(0.2);
  EXPECT_TRUE(protocol_.over());
}

TEST_F(AgentProtocolTest, AFrameLongAfterTheLossMeansThatTheServiceHasReturned) {
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  Answer(true);
  Joins(5.0);
  SendFrame(1);
  Joins(30.0);
  EXPECT_FALSE(protocol_.over());
}

TEST_F(AgentProtocolTest, AnAgentWhoseRobotsWereDeletedMeanwhileEnds) {
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  SendSession(1, Without({"r0", "r1"}));
  EXPECT_FALSE(PollAfter(0.0).has_value());
  EXPECT_TRUE(protocol_.over());
  EXPECT_TRUE(protocol_.failure().ok());
}

TEST_F(AgentProtocolTest, AnAgentThatIsStartedAgainAfterItsRobotsWereDeletedEnds) {
  options_.robots = {"r0"};
  options_.skip_unavailable = true;
  SendSession(1, Without({"r0"}));
  PerformTask();
  EXPECT_TRUE(protocol_.over());
  EXPECT_TRUE(protocol_.failure().ok());
}

TEST_F(AgentProtocolTest, AMemberThatWasLostLeavesRobotsWithAnotherAgentAndKeepsTheMemoryOfTheRest) {
  options_.robots = {"r0", "r1"};
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  Joined();
  RefuseFor({"r1"});
  EXPECT_FALSE(protocol_.over());
  EXPECT_THAT(protocol_.DrainNotices(), testing::Contains("r1 has another agent now"));
  PerformTask();
  const JoinMessage join = Joined();
  EXPECT_THAT(join.robots, ElementsAre("r0"));
  EXPECT_THAT(join.process_robots, ElementsAre("r0", "r1")) << "its keys have the name of both";
  EXPECT_EQ(join.memory, (ControllerCheckpoint{0, 0, true}));
  RefuseFor({"r1"});  // late
  EXPECT_FALSE(protocol_.has_task());
  Answer(true);
  SendFrame(1);
  ASSERT_THAT(endpoint_.sent, SizeIs(2));
  EXPECT_THAT(endpoint_.sent.back().proposals, SizeIs(1));
}

TEST_F(AgentProtocolTest, AnAgentThatIsStartedWhileTheRunGoesOnLeavesAllItsRobotsToOthers) {
  options_.robots = {"r0", "r1"};
  options_.skip_unavailable = true;
  SendSession();
  PerformTask();
  Joined();
  RefuseFor({"r0", "r1"});
  PerformTask();
  EXPECT_TRUE(protocol_.over());
  EXPECT_TRUE(protocol_.failure().ok());
}

TEST_F(AgentProtocolTest, AFirstAgentWhoseRobotHasAnotherOneFails) {
  SendSession();
  PerformTask();
  Joined();
  RefuseFor({"r1"});
  EXPECT_TRUE(protocol_.over());
  EXPECT_THAT(protocol_.failure().error().message, HasSubstr("has an agent already"));
}

TEST_F(AgentProtocolTest, AServiceThatIsLostDuringAChangeIsJoinedAfterIt) {
  JoinAndRun();
  SendSession(1, Without({"r1"}));
  SendFrame(0, 1);
  ReplicaTask task = protocol_.BeginTask().value();
  protocol_.OnServiceLost(now_);
  EXPECT_FALSE(PollAfter(0.0).has_value());
  Finish(task);
  EXPECT_THAT(endpoint_.sent, SizeIs(1));
  const JoinMessage join = Joined();
  EXPECT_EQ(join.world_hash, Hash(Without({"r1"})));
  Answer(true);
  EXPECT_THAT(endpoint_.sent, SizeIs(2));
}

TEST_F(AgentProtocolTest, AServiceThatIsLostBeforeItsAnswerMayBeReplaced) {
  SendSession();
  PerformTask();
  Joined();
  protocol_.OnServiceLost(now_);
  EXPECT_FALSE(PollAfter(1.0).has_value());
  SendSession(0, World(), kRun + 1);
  PerformTask();
  EXPECT_EQ(PollAfter(0.0)->run, kRun + 1);
}

TEST_F(AgentProtocolTest, AReplicaForASessionThatWasReplacedIsOfNoUse) {
  SendSession();
  ReplicaTask task = protocol_.BeginTask().value();
  SendSession(0, World(), kRun + 1);
  Finish(task);
  EXPECT_NE(task.robots.replica, nullptr);
  PerformTask();
  EXPECT_EQ(PollAfter(0.0)->run, kRun + 1);
}

TEST_F(AgentProtocolTest, TheLastFrameDuringAChangeEndsTheAgent) {
  JoinAndRun();
  SendSession(1, Without({"r1"}));
  SendFrame(0, 1);
  ReplicaTask task = protocol_.BeginTask().value();
  FrameMessage last = Frame(0, 1);
  last.last = true;
  protocol_.OnFrame(last, now_);
  Finish(task);
  EXPECT_TRUE(protocol_.over());
  EXPECT_TRUE(protocol_.failure().ok());
  EXPECT_THAT(endpoint_.sent, SizeIs(1));
  EXPECT_NE(task.robots.replica, nullptr);
}

TEST_F(AgentProtocolTest, AServiceThatEndsWhileTheReplicaIsMadeIsReplacedByTheNext) {
  SendSession();
  ReplicaTask task = protocol_.BeginTask().value();
  protocol_.OnServiceGone(now_);
  Finish(task);
  EXPECT_EQ(PollAfter(1.0), std::nullopt);
  EXPECT_FALSE(protocol_.over());
  SendSession(0, World(), kRun + 1);
  PerformTask();
  EXPECT_EQ(PollAfter(0.0)->run, kRun + 1);
}

TEST_F(AgentProtocolTest, ABadFrameIsIgnoredAndReportedOnce) {
  JoinAndRun();
  const std::size_t answers = endpoint_.sent.size();
  protocol_.DrainNotices();
  FrameMessage not_finite = Frame(5);
  not_finite.state.robots[0].X_WR.x = std::nan("");
  FrameMessage too_short = Frame(6);
  too_short.state.robots.pop_back();
  for (int i = 0; i < 3; ++i) protocol_.OnFrame(not_finite, now_);
  protocol_.OnFrame(too_short, now_);
  EXPECT_FALSE(protocol_.over());
  EXPECT_THAT(endpoint_.sent, SizeIs(answers));
  EXPECT_THAT(protocol_.DrainNotices(),
              ElementsAre(StartsWith("ignored a bad frame of the world service: "),
                          "ignored a bad frame of the world service: found a state of 1 robots, expected 2"));
  SendFrame(3);
  EXPECT_THAT(endpoint_.sent, SizeIs(answers + 1)) << "the frames of the service count as before";
}

TEST_F(AgentProtocolTest, FramesAreAnsweredInTheirOrderAndAgainOnlyIfTheAnswerIsMissing) {
  JoinAndRun();
  SendFrame(3);
  SendFrame(2);
  ASSERT_THAT(endpoint_.sent, SizeIs(2));
  FrameMessage resent = Frame(3);
  resent.awaited = {99};
  protocol_.OnFrame(resent, now_);
  EXPECT_THAT(endpoint_.sent, SizeIs(2));
  resent.awaited = {99, kAgent};
  protocol_.OnFrame(resent, now_);
  ASSERT_THAT(endpoint_.sent, SizeIs(3));
  EXPECT_EQ(endpoint_.sent[2], endpoint_.sent[1]);
}

TEST_F(HistoryTest, TheEndOfTheServiceEndsAMemberWhoseRobotsProcessAHistory) {
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  Joined();
  protocol_.OnHistory(HistoryOf(ControllerCheckpoint{0, 0, true}, {Entry(1)}));
  ReplicaTask task = protocol_.BeginTask().value();
  protocol_.OnServiceGone(now_);
  Finish(task);
  ASSERT_TRUE(protocol_.over());
  EXPECT_TRUE(protocol_.failure().ok());
}

TEST_F(HistoryTest, ANewerWorldReplacesThatOfAnAgentThatWasNeverAdmitted) {
  Prepare();
  protocol_.OnHistory(HistoryOf({}, {Entry(0)}));
  ReplicaTask task = protocol_.BeginTask().value();
  SendSession(1, Without({"r1"}));
  Finish(task);
  PerformTask();  // the replica of the newer world
  const JoinMessage join = Joined();
  EXPECT_EQ(join.world_edition, 1u);
  EXPECT_THAT(join.robots, ElementsAre("r0"));
  EXPECT_EQ(join.memory, std::nullopt);
}

// Another service continues the run.
class IncarnationTest : public AgentProtocolTest {
 protected:
  static FrameMessage FrameOf(Incarnation incarnation, Tick tick) {
    FrameMessage frame = Frame(tick);
    frame.incarnation = incarnation;
    return frame;
  }
  void AnswerAs(Incarnation incarnation) {
    AdmissionMessage admission{kRun, kAgent, true, {}};
    admission.incarnation = incarnation;
    protocol_.OnAdmission(admission);
  }
};

TEST_F(IncarnationTest, ALaterServiceIsJoinedAtOnceAndGetsTheSameAnswer) {
  JoinAndRun();
  protocol_.OnFrame(FrameOf(2, 0), now_);
  const JoinMessage join = Joined();
  EXPECT_EQ(join.incarnation, 2u);
  EXPECT_EQ(join.run, kRun);
  AnswerAs(2);
  protocol_.OnFrame(FrameOf(2, 0), now_);
  ASSERT_GE(endpoint_.sent.size(), 2u);
  ProposalMessage expected = endpoint_.sent.front();
  expected.incarnation = 2;
  EXPECT_EQ(endpoint_.sent.back(), expected);
}

TEST_F(IncarnationTest, AnEarlierServiceHasNoEffectAnyMore) {
  JoinAndRun();
  protocol_.OnSession(SessionMessage{.run = kRun, .world = World(), .incarnation = 1});
  Joined();
  AnswerAs(0);
  EXPECT_FALSE(protocol_.is_running());
  AnswerAs(1);
  ASSERT_TRUE(protocol_.is_running());
  const std::size_t sent = endpoint_.sent.size();
  SendFrame(1);
  FrameMessage last = Frame(1);
  last.last = true;
  protocol_.OnFrame(last, now_);
  EXPECT_EQ(endpoint_.sent.size(), sent);
  EXPECT_FALSE(protocol_.over());
}

TEST_F(IncarnationTest, ALaterServiceIsJoinedAfterTheChangeThatHasBegun) {
  JoinAndRun();
  SendSession(1, Without({"r1"}));
  SendFrame(0, 1);
  ReplicaTask task = protocol_.BeginTask().value();
  protocol_.OnFrame(FrameOf(1, 0), now_);
  EXPECT_EQ(PollAfter(1.0), std::nullopt);
  Finish(task);
  EXPECT_THAT(protocol_.DrainNotices(), ElementsAre("another world service continues the run"));
  const JoinMessage join = Joined();
  EXPECT_EQ(join.incarnation, 1u);
  EXPECT_EQ(join.world_edition, 1u);
  AnswerAs(1);
  EXPECT_THAT(protocol_.DrainNotices(), ElementsAre("joined the run again"));
  EXPECT_THAT(endpoint_.sent, SizeIs(2)) << "the frame that was kept";
}

TEST_F(IncarnationTest, ALaterServiceEndsTheWaitForALostOne) {
  JoinAndRun();
  protocol_.OnServiceLost(now_);
  protocol_.OnFrame(FrameOf(1, 0), now_);
  AnswerAs(1);
  PollAfter(1000.0);
  EXPECT_FALSE(protocol_.over());
}

}  // namespace
}  // namespace troupe
