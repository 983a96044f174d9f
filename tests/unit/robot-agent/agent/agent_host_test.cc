#include "robot-agent/agent/agent_host.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <future>
#include <set>
#include <stdexcept>
#include <thread>

#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "tests/unit/robot-agent/agent/scripted_service.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

std::string Library(const std::string& variant) {
  return std::string(TEST_LIBRARY_FOLDER) + "/libcontroller_" + variant + ".so";
}

// Two robots: r0 drives by a script, r1 stands.
WorldDescription TwoRobots(const std::string& controller = "script",
                           const std::string& parameters = R"({"commands": [{"at": 0, "vx": 0.5}]})") {
  SmallWorld world;
  const RobotId r0 = world.AddRobot("r0", {});
  world.AddRobot("r1", {2.0, 0.0, 0.0, 0.0});
  world.SetController(r0, controller, parameters);
  return world.world();
}

TEST(AgentHostTest, JoinsWithItsRobotsAndTheHashOfTheWorld) {
  ScriptedService service(TwoRobots());
  service.StartAgent({"r1", "r0"});
  service.SendSession();
  const JoinMessage join = service.AwaitJoin();
  EXPECT_EQ(join.run, 1u);
  EXPECT_EQ(join.agent, 7u);
  EXPECT_EQ(join.protocol_version, kProtocolVersion);
  EXPECT_EQ(join.world_hash, Hash(TwoRobots()));
  EXPECT_THAT(join.robots, ElementsAre("r0", "r1"));
}

TEST(AgentHostTest, WithoutNamesSimulatesAllRobots) {
  ScriptedService service(TwoRobots());
  service.StartAgent();
  service.SendSession();
  EXPECT_THAT(service.AwaitJoin().robots, ElementsAre("r0", "r1"));
}

TEST(AgentHostTest, RepeatsItsJoinUntilAnswered) {
  ScriptedService service(TwoRobots());
  service.StartAgent();
  service.SendSession();
  EXPECT_EQ(service.AwaitJoin(3).run, 1u);
}

TEST(AgentHostTest, AnswersAFrameWithOneProposalForTheNextTick) {
  ScriptedService service(TwoRobots());
  service.StartAndAdmit();
  service.SendFrame(0);
  ASSERT_THAT(service.proposals(), SizeIs(1));
  const ProposalMessage answer = service.proposals()[0];
  EXPECT_EQ(answer.run, 1u);
  EXPECT_EQ(answer.agent, 7u);
  EXPECT_EQ(answer.tick, 1u);
  EXPECT_THAT(answer.proposals, ElementsAre(Proposal{RobotId(0), {0.5, 0.0, 0.0}}, Proposal{RobotId(1), {}}));
  EXPECT_THAT(answer.reports, IsEmpty());
}

TEST(AgentHostTest, ProposesForItsOwnRobotsOnly) {
  ScriptedService service(TwoRobots());
  service.StartAndAdmit({"r1"});
  service.SendFrame(0);
  EXPECT_THAT(service.proposals().at(0).proposals, ElementsAre(Proposal{RobotId(1), {}}));
}

TEST(AgentHostTest, ARepeatedFrameHasTheSameAnswer) {
  // Each decision of this controller differs from the one before.
  ScriptedService service(TwoRobots(Library("throws_later"), "{}"));
  service.StartAndAdmit();
  service.SendFrame(3);
  service.SendFrame(3);
  const std::vector<ProposalMessage> answers = service.proposals();
  ASSERT_THAT(answers, SizeIs(2));
  EXPECT_EQ(answers[0].tick, answers[1].tick);
  EXPECT_EQ(answers[0].proposals, answers[1].proposals);
  EXPECT_EQ(answers[0].reports, answers[1].reports);
}

TEST(AgentHostTest, AnOlderFrameIsNotAnswered) {
  ScriptedService service(TwoRobots());
  service.StartAndAdmit();
  service.SendFrame(5);
  service.SendFrame(4);
  EXPECT_THAT(service.proposals(), SizeIs(1));
}

TEST(AgentHostTest, AfterMissedFramesItContinuesFromTheNewest) {
  ScriptedService service(TwoRobots());
  service.StartAndAdmit();
  service.SendFrame(0);
  service.SendFrame(17);
  EXPECT_EQ(service.proposals().at(1).tick, 18u);
}

// A frame of a pause.
FrameMessage Paused(const ScriptedService& service, Tick tick) {
  FrameMessage frame = service.Frame(tick);
  frame.paused = true;
  return frame;
}

TEST(AgentHostTest, PausesAtAPausedFrameAndAnswersItWhenTimeContinues) {
  ScriptedService service(TwoRobots());
  service.StartAndAdmit();
  service.Send(&AgentHandler::OnFrame, Paused(service, 3));
  ASSERT_THAT(service.proposals(), SizeIs(1));
  EXPECT_TRUE(service.proposals()[0].paused);
  EXPECT_EQ(service.proposals()[0].tick, 4u);
  EXPECT_THAT(service.proposals()[0].proposals, IsEmpty());
  service.Send(&AgentHandler::OnFrame, Paused(service, 3));  // another agent missed it
  ASSERT_THAT(service.proposals(), SizeIs(2));
  EXPECT_TRUE(service.proposals()[1].paused);
  service.SendFrame(3);
  ASSERT_THAT(service.proposals(), SizeIs(3));
  EXPECT_FALSE(service.proposals()[2].paused);
  EXPECT_EQ(service.proposals()[2].tick, 4u);
  EXPECT_THAT(service.proposals()[2].proposals, SizeIs(2));
  service.Send(&AgentHandler::OnFrame, Paused(service, 3));  // late
  EXPECT_THAT(service.proposals(), SizeIs(3));
}

TEST(AgentHostTest, APauseChangesNoAnswer) {
  const std::string wander = R"({"min_distance": 0.5})";
  ScriptedService straight(TwoRobots("wander", wander));
  ScriptedService with_pauses(TwoRobots("wander", wander));
  straight.StartAndAdmit();
  with_pauses.StartAndAdmit();
  for (Tick tick = 0; tick < 10; ++tick) {
    straight.SendFrame(tick);
    with_pauses.Send(&AgentHandler::OnFrame, Paused(with_pauses, tick));
    with_pauses.SendFrame(tick);
    EXPECT_EQ(with_pauses.proposals().back(), straight.proposals().back());
  }
}

TEST(AgentHostTest, AFrameOfAnotherRunIsNotAnswered) {
  ScriptedService service(TwoRobots());
  service.StartAndAdmit();
  service.SendFrame(0, 2);
  EXPECT_THAT(service.proposals(), IsEmpty());
  service.SendFrame(0);
  EXPECT_THAT(service.proposals(), SizeIs(1));
}

TEST(AgentHostTest, AFrameThatOvertakesTheAdmissionIsAnsweredAfterIt) {
  ScriptedService service(TwoRobots());
  service.StartAgent();
  service.SendSession();
  service.AwaitJoin();
  service.SendFrame(0);
  EXPECT_THAT(service.proposals(), IsEmpty());
  service.Admit();
  EXPECT_EQ(service.proposals().at(0).tick, 1u);
  service.Admit();  // the answer to a repeated join
  EXPECT_THAT(service.proposals(), SizeIs(1));
}

TEST(AgentHostTest, AdmissionsOfOthersAreNotItsOwn) {
  ScriptedService service(TwoRobots());
  service.StartAgent();
  service.SendSession();
  service.AwaitJoin();
  service.Send(&AgentHandler::OnAdmission, AdmissionMessage{1, 8, false, "not you"});
  service.Send(&AgentHandler::OnAdmission, AdmissionMessage{2, 7, false, "not this run"});
  service.SendFrame(0);
  EXPECT_THAT(service.proposals(), IsEmpty());
  service.Admit();
  EXPECT_THAT(service.proposals(), SizeIs(1));
}

TEST(AgentHostTest, EndsWhenTheRunIsOver) {
  ScriptedService service(TwoRobots());
  service.StartAndAdmit();
  service.SendFrame(0);
  service.SendLast(1);
  EXPECT_EQ(test::ValueOf(service.AwaitEnd()), AgentEnd::kRunOver);
  EXPECT_THAT(service.proposals(), SizeIs(1));
}

TEST(AgentHostTest, EndsWhenTheFrameThatItAnsweredTurnsOutToBeTheLast) {
  ScriptedService service(TwoRobots());
  service.StartAndAdmit();
  service.SendFrame(4);
  service.SendLast(4);
  EXPECT_EQ(test::ValueOf(service.AwaitEnd()), AgentEnd::kRunOver);
}

TEST(AgentHostTest, EndsOnStop) {
  ScriptedService waiting(TwoRobots());
  waiting.StartAgent();
  waiting.Stop();
  ASSERT_TRUE(waiting.AwaitEnd().ok());
  EXPECT_EQ(waiting.AwaitEnd().value(), AgentEnd::kStopped);

  ScriptedService running(TwoRobots());
  running.StartAndAdmit();
  running.Stop();
  ASSERT_TRUE(running.AwaitEnd().ok());
  EXPECT_EQ(running.AwaitEnd().value(), AgentEnd::kStopped);
}

TEST(AgentHostTest, ARefusalIsBadInput) {
  ScriptedService service(TwoRobots());
  service.StartAgent();
  service.SendSession();
  service.AwaitJoin();
  service.Admit(1, false, "robot r0 is taken");
  EXPECT_EQ(service.AwaitError(), "error: the world service refused: robot r0 is taken");
  EXPECT_EQ(service.AwaitEnd().error().code, ErrorCode::kBadInput);
}

TEST(AgentHostTest, AnUnknownRobotIsNamedWithTheKnownOnes) {
  ScriptedService service(TwoRobots());
  service.StartAgent({"r0", "r7"});
  service.SendSession();
  EXPECT_EQ(service.AwaitError(), "error: the world has no robot 'r7', expected one of: r0, r1");
  EXPECT_EQ(service.AwaitEnd().error().code, ErrorCode::kBadInput);
}

TEST(AgentHostTest, ARobotNamedTwiceIsAnError) {
  ScriptedService service(TwoRobots());
  service.StartAgent({"r0", "r0"});
  service.SendSession();
  EXPECT_EQ(service.AwaitError(), "error: robot 'r0' is named twice");
  EXPECT_EQ(service.AwaitEnd().error().code, ErrorCode::kBadInput);
}

TEST(AgentHostTest, AControllerThatCannotBeMadeIsAnError) {
  ScriptedService service(TwoRobots("wander", R"({"speed": "fast"})"));
  service.StartAgent();
  service.SendSession();
  EXPECT_EQ(service.AwaitError(),
            "error: robot r0: wander: found the string 'fast' as 'speed', expected a number between 0 and 100");
  EXPECT_EQ(service.AwaitEnd().error().code, ErrorCode::kBadInput);
}

TEST(AgentHostTest, AnotherProtocolVersionIsAnError) {
  ScriptedService service(TwoRobots());
  service.StartAgent();
  SessionMessage session = service.Session();
  session.protocol_version = kProtocolVersion + 1;
  service.Send(&AgentHandler::OnSession, session);
  EXPECT_THAT(service.AwaitError(), HasSubstr("protocol version"));
  EXPECT_EQ(service.AwaitEnd().error().code, ErrorCode::kFailure);
}

TEST(AgentHostTest, AWorldThatBreaksItsRulesIsAnError) {
  ScriptedService service(TwoRobots());
  service.StartAgent();
  SessionMessage session = service.Session();
  session.world.Change().models[0].X_PM.x = std::nan("");
  service.Send(&AgentHandler::OnSession, session);
  EXPECT_THAT(service.AwaitError(), StartsWith("error: the world service on here sent a bad world: "));
}

TEST(AgentHostTest, WithoutASessionItGivesUp) {
  ScriptedService service(TwoRobots());
  service.StartAgent({}, "", 0.05);
  EXPECT_EQ(service.AwaitError(), "error: no world service appeared within 0.05 s");
}

// Its last frame may be lost on the way, and all answers of the agent have entered the run.
TEST(AgentHostTest, AServiceThatEndsInOrderEndsTheAgent) {
  ScriptedService service(TwoRobots());
  service.StartAndAdmit();
  service.SendFrame(0);
  service.Leave();
  EXPECT_EQ(service.AwaitEnd().value(), AgentEnd::kRunOver);
}

TEST(AgentHostTest, AServiceThatWasLostAndReturnsIsJoinedAgain) {
  ScriptedService service(TwoRobots());
  service.StartAndAdmit();
  service.SendFrame(0);
  service.Lose();
  const JoinMessage join = service.AwaitJoin(2);
  EXPECT_EQ(join.run, 1u);
  EXPECT_EQ(join.agent, 7u);
  EXPECT_THAT(join.robots, ElementsAre("r0", "r1"));
  service.SendFrame(1);
  EXPECT_THAT(service.proposals(), SizeIs(1));
  service.Admit();
  EXPECT_EQ(service.AwaitProposal(2).tick, 2u);
}

TEST(AgentHostTest, AServiceThatEndsBeforeItAnswersMayBeReplaced) {
  ScriptedService service(TwoRobots());
  service.StartAgent();
  service.SendSession(1);
  service.AwaitJoinOf(1);
  service.Leave();
  service.SendSession(2);
  service.AwaitJoinOf(2);
  service.Admit(2);
  service.SendFrame(0, 2);
  EXPECT_EQ(service.proposals().at(0).run, 2u);
}

TEST(AgentHostTest, ANewRunReplacesOneThatDidNotAnswer) {
  ScriptedService service(TwoRobots());
  service.StartAgent();
  service.SendSession(1);
  service.AwaitJoinOf(1);
  service.SendSession(2);
  service.AwaitJoinOf(2);
}

TEST(AgentHostTest, AFailingControllerIsReportedOnceAndItsRobotStands) {
  ScriptedService service(TwoRobots(Library("throws_later"), "{}"));
  service.StartAndAdmit();
  for (Tick tick = 0; tick < 6; ++tick) service.SendFrame(tick);
  const std::vector<ProposalMessage> answers = service.proposals();
  ASSERT_THAT(answers, SizeIs(6));
  EXPECT_EQ(answers[2].proposals[0].twist.vx, 0.25);
  EXPECT_THAT(answers[2].reports, IsEmpty());
  EXPECT_THAT(answers[3].reports, ElementsAre(HasSubstr("failed at tick 3: out of ideas")));
  EXPECT_THAT(answers[4].reports, IsEmpty());
  for (std::size_t i = 3; i < 6; ++i) EXPECT_TRUE(answers[i].proposals[0].twist.IsZero());
}

TEST(AgentHostTest, ASubscriptionToAnUnknownSensorIsAnError) {
  ScriptedService service(TwoRobots(Library("bad_subscription"), "{}"));
  service.StartAgent();
  service.SendSession();
  EXPECT_THAT(service.AwaitError(), HasSubstr("subscribes to sensor 7, but the robot has 0"));
}

TEST(AgentHostTest, AScanLogThatCannotBeOpenedIsAnError) {
  ScriptedService service(TwoRobots());
  service.StartAgent({}, "/nowhere/scans");
  EXPECT_EQ(service.AwaitError(), "/nowhere/scans: error: cannot write scans here: No such file or directory");
  EXPECT_EQ(service.AwaitEnd().error().code, ErrorCode::kOutputFailed);
}

TEST(AgentHostTest, AFullDiskEndsItWithAnError) {
  SmallWorld world;
  world.AddRanger(world.AddRobot("r0", {}), {}, {Fan(1.0, 100)});
  ScriptedService service(world.world());
  service.StartAndAdmit({}, "/dev/full");
  for (Tick tick = 0; tick < 100; ++tick) service.SendFrame(tick);
  EXPECT_EQ(service.AwaitError(), "/dev/full: error: cannot write scans: No space left on device");
}

// The gateways of an agent, as a test sees them.
struct GatewayRecord {
  std::set<std::thread::id> threads;  // on which gateways began and ended
  std::size_t begun = 0;              // gateways
  std::size_t ended = 0;
  std::function<void()> on_begin = [] {};  // called when a gateway begins
};

class RecordedGateway final : public Gateway {
 public:
  explicit RecordedGateway(GatewayRecord& record) : record_(record) {
    record_.threads.insert(std::this_thread::get_id());
    ++record_.begun;
    record_.on_begin();
  }
  ~RecordedGateway() override {
    record_.threads.insert(std::this_thread::get_id());
    ++record_.ended;
  }
  ExternalCommand CommandFor(RobotId, const WorldState&) override { return {}; }
  void Publish(Tick, std::span<const RobotView* const>) override {}
  std::vector<std::string> DrainReports() override { return {}; }

 private:
  GatewayRecord& record_;
};

// An agent of both robots with a gateway, in a world that the test edits.
class EditedAgentTest : public testing::Test {
 protected:
  void StartAndAnswerTick0() {
    service_.SetGateway(
        [this](const Scene&, const std::vector<RobotId>&) { return std::make_unique<RecordedGateway>(gateways_); });
    service_.StartAndAdmit();
    service_.SendFrame(0);
    service_.AwaitProposal(1);
  }

  // TwoRobots() without the robots of these names.
  static WorldDescription Without(const std::set<std::string>& robots) {
    WorldDescription world = TwoRobots();
    for (ModelDescription& model : world.models) model.removed = robots.contains(model.name);
    return world;
  }
  void SendSession(Edition edition, const WorldDescription& world) {
    SessionMessage session = service_.Session();
    session.world_edition = edition;
    session.world = world;
    service_.Send(&AgentHandler::OnSession, session);
  }
  // The newest frame is of an edition that has changed the world.
  void SendFrame(Edition edition, Tick tick, bool paused = true) {
    FrameMessage frame = service_.Frame(tick);
    frame.edition = frame.world_edition = edition;
    frame.paused = paused;
    service_.Send(&AgentHandler::OnFrame, frame);
  }
  // Sends the world of an edition and its first frame.
  void Edit(Edition edition, const WorldDescription& world) {
    SendSession(edition, world);
    SendFrame(edition, 0);
  }

  GatewayRecord gateways_;
  ScriptedService service_{TwoRobots()};
};

TEST_F(EditedAgentTest, GatewaysBeginAndEndOnOneThreadAndThatDeliversNothing) {
  StartAndAnswerTick0();
  Edit(1, Without({"r1"}));
  EXPECT_EQ(service_.AwaitProposal(2).edition, 1u);
  SendFrame(1, 0, false);
  EXPECT_THAT(service_.AwaitProposal(3).proposals, SizeIs(1));
  Edit(2, Without({"r0", "r1"}));
  EXPECT_EQ(service_.AwaitEnd().value(), AgentEnd::kRunOver);
  EXPECT_EQ(gateways_.begun, 2u);
  EXPECT_EQ(gateways_.ended, 2u);
  EXPECT_THAT(gateways_.threads, SizeIs(1));
  EXPECT_FALSE(gateways_.threads.contains(std::this_thread::get_id())) << "which delivers";
}

TEST_F(EditedAgentTest, DeliveriesDoNotWaitForAChangeAndTheNewestFrameIsAnsweredAfterIt) {
  std::promise<void> may_continue;
  StartAndAnswerTick0();
  gateways_.on_begin = [&] { may_continue.get_future().wait(); };
  Edit(1, Without({"r1"}));
  SendFrame(1, 0);  // resent
  SendFrame(1, 3);
  SendFrame(1, 2);  // late
  EXPECT_THAT(service_.proposals(), SizeIs(1));
  may_continue.set_value();
  const ProposalMessage answer = service_.AwaitProposal(2);
  EXPECT_EQ(answer.edition, 1u);
  EXPECT_EQ(answer.tick, 4u);
}

TEST_F(EditedAgentTest, FollowsEachOfTwoEditsInARow) {
  std::promise<void> may_continue;
  StartAndAnswerTick0();
  gateways_.on_begin = [&] { may_continue.get_future().wait(); };
  Edit(1, Without({"r1"}));
  Edit(2, Without({"r0", "r1"}));  // of which the agent need not be asked
  may_continue.set_value();
  EXPECT_EQ(service_.AwaitEnd().value(), AgentEnd::kRunOver);
}

TEST_F(EditedAgentTest, TheAgentOfADeletedRobotLeavesEvenIfAResetFollowsAtOnce) {
  std::promise<void> may_continue;
  StartAndAnswerTick0();
  gateways_.on_begin = [&] { may_continue.get_future().wait(); };
  Edit(1, Without({"r1"}));
  may_continue.set_value();
  service_.AwaitProposal(2);
  Edit(2, Without({"r0", "r1"}));
  FrameMessage reset = service_.Frame(0);
  reset.edition = reset.world_edition = reset.fresh_edition = 3;
  reset.paused = true;
  SendSession(3, TwoRobots());
  service_.Send(&AgentHandler::OnFrame, reset);
  EXPECT_EQ(service_.AwaitEnd().value(), AgentEnd::kRunOver);
  EXPECT_THAT(service_.proposals(), SizeIs(2));
}

TEST_F(EditedAgentTest, FollowsAWorldThatChangedWithoutIt) {
  StartAndAnswerTick0();
  SendSession(1, Without({"r0"}));
  Edit(2, Without({"r1"}));
  const ProposalMessage answer = service_.AwaitProposal(2);
  EXPECT_EQ(answer.edition, 2u);
  EXPECT_TRUE(answer.paused);
}

TEST_F(EditedAgentTest, ARunThatEndsDuringAChangeIsOver) {
  std::promise<void> has_begun;
  std::promise<void> may_continue;
  StartAndAnswerTick0();
  gateways_.on_begin = [&] {
    has_begun.set_value();
    may_continue.get_future().wait();
  };
  Edit(1, Without({"r1"}));
  has_begun.get_future().wait();
  service_.SendLast(0);
  may_continue.set_value();
  EXPECT_EQ(service_.AwaitEnd().value(), AgentEnd::kRunOver);
  EXPECT_EQ(gateways_.ended, 2u);
  EXPECT_THAT(service_.proposals(), SizeIs(1));
}

TEST_F(EditedAgentTest, AGatewayThatCannotBeMadeIsAnError) {
  StartAndAnswerTick0();
  gateways_.on_begin = [] { throw std::runtime_error("no network"); };
  Edit(1, Without({"r1"}));
  EXPECT_EQ(service_.AwaitError(), "error: the world was edited, and this agent cannot continue: no network");
}

TEST(AgentHostTest, FailsWithoutMemoryForAMessage) {
  ScriptedService service(TwoRobots());
  service.StartAndAdmit();
  service.RunOutOfMemory();
  const Result<AgentEnd> end = service.AwaitEnd();
  ASSERT_FALSE(end.ok());
  EXPECT_EQ(end.error().message, "there is not enough memory");
  EXPECT_EQ(end.error().code, ErrorCode::kFailure);
}

}  // namespace
}  // namespace troupe
