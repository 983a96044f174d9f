// Editing the world of a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/world-service/service/coordinator_fixture.h"

namespace troupe::test {
namespace {

using testing::IsEmpty;

class EditTest : public CoordinatorTest {
 protected:
  void Ask(const control::Request& request, std::shared_ptr<const WorldDescription> world = nullptr) {
    coordinator->Control(request, [this](const ControlReply& reply) { replies.push_back(reply); }, now,
                         {std::move(world)});
  }
  void AnswerPaused(AgentId agent) {
    ProposalMessage message = ProposalOf(agent, 0.0);
    message.proposals.clear();
    message.paused = true;
    coordinator->OnProposal(message, now);
  }
  const FrameMessage& newest() const { return endpoint.frames.back(); }

  std::vector<ControlReply> replies;
};

TEST_F(EditTest, ResetsInAPauseOfItsOwnAndPlaysOn) {
  MakeAndStart(1);
  const std::uint64_t first_hash = newest().state_hash;
  Propose(1);
  Ask(control::Reset());
  EXPECT_THAT(replies, IsEmpty());
  Propose(1);
  EXPECT_TRUE(newest().paused);
  EXPECT_EQ(tick(), 2u);
  EXPECT_EQ(newest().edition, 0u);
  AnswerPaused(1);
  EXPECT_EQ(CoordinatorTest::Ask(control::GetStatus()).open_requests, 1u);
  EXPECT_EQ(newest().edition, 1u);
  EXPECT_EQ(newest().fresh_edition, 1u);
  EXPECT_EQ(newest().world_edition, 0u) << "the world is the same";
  EXPECT_EQ(tick(), 0u);
  EXPECT_EQ(newest().state_hash, first_hash);
  EXPECT_TRUE(newest().paused);
  EXPECT_THAT(replies, IsEmpty()) << "the agent does not have it yet";
  AnswerPaused(1);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_TRUE(replies[0].done) << replies[0].problem;
  EXPECT_EQ(replies[0].tick, 0u);
  EXPECT_EQ(replies[0].edition, 1u);
  EXPECT_EQ(replies[0].state, RunState::kPlaying);
  EXPECT_FALSE(newest().paused);
  Propose(1);
  EXPECT_EQ(tick(), 1u);
  EXPECT_EQ(newest().edition, 1u);
  EXPECT_EQ(endpoint.sessions.size(), 0u) << "the session is still valid";
}

TEST_F(EditTest, LeavesARunPausedThatWasPaused) {
  options.start_paused = true;
  MakeAndStart(1);
  AnswerPaused(1);
  Ask(control::Reset());
  EXPECT_EQ(newest().edition, 1u);
  AnswerPaused(1);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].state, RunState::kPaused);
  EXPECT_TRUE(newest().paused);
}

TEST_F(EditTest, IgnoresAnswersToFramesBeforeTheEdit) {
  options.start_paused = true;
  MakeAndStart(1);
  AnswerPaused(1);
  ProposalMessage late = ProposalOf(1, 0.0);
  late.proposals.clear();
  late.paused = true;
  Ask(control::Reset());
  coordinator->OnProposal(late, now);
  EXPECT_THAT(replies, IsEmpty());
  late.edition = 2;
  coordinator->OnProposal(late, now);
  EXPECT_THAT(replies, IsEmpty());
  EXPECT_THAT(Events(), testing::Contains("proposal_rejected")) << "from the future";
  AnswerPaused(1);
  EXPECT_EQ(replies.size(), 1u);
}

TEST_F(EditTest, IsExecutedInTurnWithSteps) {
  options.start_paused = true;
  MakeAndStart(1);
  Ask(control::Step());
  Ask(control::Reset());
  Ask(control::Step());
  AnswerPaused(1);
  Propose(1);
  AnswerPaused(1);
  EXPECT_EQ(newest().edition, 1u);
  EXPECT_EQ(tick(), 0u);
  AnswerPaused(1);
  Propose(1);
  AnswerPaused(1);
  ASSERT_EQ(replies.size(), 3u);
  EXPECT_EQ(replies[0].tick, 1u);
  EXPECT_EQ(replies[1].tick, 0u);
  EXPECT_EQ(replies[2].tick, 1u);
}

TEST_F(EditTest, IsExecutedAlsoWhenTheRunIsSetToPlay) {
  options.start_paused = true;
  MakeAndStart(1);
  Ask(control::Reset());
  Ask(control::Play());
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].state, RunState::kPlaying);
  AnswerPaused(1);
  EXPECT_EQ(newest().edition, 1u);
  AnswerPaused(1);
  EXPECT_EQ(replies.size(), 2u);
  EXPECT_FALSE(newest().paused);
}

TEST_F(EditTest, PausesAfterAnEditIfAskedMeanwhile) {
  MakeAndStart(1);
  Ask(control::Reset());
  Ask(control::Pause());
  Propose(1);
  AnswerPaused(1);
  AnswerPaused(1);
  EXPECT_EQ(replies.size(), 2u);
  EXPECT_TRUE(newest().paused);
}

TEST_F(EditTest, IsRefusedBeforeTheRunHasBegun) {
  Make(1);
  Ask(control::Reset());
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].problem, "the run has not begun; nothing can be changed before");
}

// The agent answered ticks that a reset has set back; the dead process says nothing of its end for a lease.
TEST_F(EditTest, AReplacementThatJoinsJustAfterAResetWaitsForTheLeaseOfTheDeadAgent) {
  MakeAndStart(1);
  for (int i = 0; i < 8; ++i) Propose(1);
  Ask(control::Reset());
  Propose(1);
  AnswerPaused(1);
  ASSERT_EQ(tick(), 0u);
  ASSERT_EQ(newest().world_edition, 0u) << "the world is the same";
  const std::size_t answers = endpoint.admissions.size();
  Join(11, {"r0"});
  now += 0.5;
  Join(11, {"r0"});
  EXPECT_EQ(endpoint.admissions.size(), answers) << "neither admitted nor refused";
  coordinator->OnAgentGone(1, now);
  Join(11, {"r0"});
  ASSERT_EQ(endpoint.admissions.size(), answers + 1);
  EXPECT_TRUE(endpoint.admissions.back().admitted);
}

TEST_F(EditTest, ResetsByScope) {
  options.start_paused = true;
  MakeAndStart(1);
  Ask(control::Step());
  AnswerPaused(1);
  Propose(1);
  AnswerPaused(1);
  ASSERT_NE(Travel(0), 0.0);
  control::Reset request;
  for (const std::uint8_t scopes : {0, 8, 15}) {
    request.scopes = scopes;
    Ask(request);
    EXPECT_FALSE(replies.back().done);
  }
  request.scopes = kResetTime;
  Ask(request);
  EXPECT_EQ(tick(), 0u);
  EXPECT_NE(Travel(0), 0.0);
  AnswerPaused(1);
  request.scopes = kResetState;
  Ask(control::Step());
  Propose(1);
  AnswerPaused(1);
  Ask(request);
  EXPECT_EQ(tick(), 1u);
  EXPECT_EQ(Travel(0), 0.0);
}

TEST_F(EditTest, IsAnsweredWhenTheRunEnds) {
  options.start_paused = true;
  MakeAndStart(1);
  AnswerPaused(1);
  Ask(control::Reset());
  Ask(control::Reset());
  coordinator->Stop(now);
  ASSERT_EQ(replies.size(), 2u);
  EXPECT_EQ(replies[0].problem, "the run is over");
  EXPECT_EQ(replies[1].problem, "the run is over");
}

TEST_F(EditTest, DoesNotWaitForAnAgentThatIsLostMeanwhile) {
  options.start_paused = true;
  MakeAndStart(2);
  AnswerPaused(1);
  AnswerPaused(2);
  Ask(control::Reset());
  AnswerPaused(1);
  coordinator->OnAgentGone(2, now);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_TRUE(replies[0].done);
}

// A run of two robots in a pause, and edits that change its entities.
class EditedWorldTest : public EditTest {
 protected:
  EditedWorldTest() {
    options.start_paused = true;
    options.start_timeout_seconds = 10.0;
  }
  void StartAndHold() {
    MakeAndStart(2);
    AnswerPaused(1);
    AnswerPaused(2);
  }
  void Spawn(const std::string& name, const Pose& pose = {0.0, -5.0, 0.0, 0.0}) {
    Ask(control::Spawn{.name = name, .pose = pose}, std::make_shared<const WorldDescription>(PlaneWorld(1)));
  }
  // Joins with an agent that has the newest world.
  void JoinNewest(AgentId agent, const std::string& robot) {
    JoinMessage join = JoinOf(agent, {robot});
    join.world_edition = endpoint.sessions.back().world_edition;
    join.world_hash = Hash(endpoint.sessions.back().world);
    coordinator->OnJoin(join, now);
  }
};

TEST_F(EditedWorldTest, MovesARobotWithoutANewSession) {
  StartAndHold();
  Ask(control::SetPose{.name = "r0", .pose = {1.0, 2.0, 0.0, 0.5}});
  EXPECT_EQ(newest().edition, 1u);
  EXPECT_EQ(newest().world_edition, 0u);
  EXPECT_EQ(newest().fresh_edition, 0u);
  EXPECT_EQ(newest().state.robots[0].X_WR, (Pose{1.0, 2.0, 0.0, 0.5}));
  EXPECT_THAT(endpoint.sessions, IsEmpty());
  AnswerPaused(1);
  AnswerPaused(2);
  EXPECT_TRUE(replies.back().done);
}

TEST_F(EditedWorldTest, ARefusalGivesItsReasonAndChangesNoState) {
  StartAndHold();
  const std::size_t before = frames();
  Ask(control::SetPose{.name = "nobody"});
  EXPECT_EQ(replies.back().problem, "the world has no entity 'nobody'");
  Ask(control::SetPose{.name = "r0", .pose = {0.1, 10.1, 0.0, 0.0}});
  EXPECT_EQ(replies.back().problem, "'r0' would be inside 'r1'");
  Ask(control::SetPose{.name = "r0", .pose = {std::nan(""), 0.0, 0.0, 0.0}});
  EXPECT_EQ(replies.back().problem, "found a pose that is not finite");
  Ask(control::Delete{""});
  EXPECT_FALSE(replies.back().done);
  Ask(control::Spawn{.name = "r9"});
  EXPECT_FALSE(replies.back().done) << "no file was read";
  Spawn("r0");
  EXPECT_EQ(replies.back().problem, "the name 'r0' is in use");
  EXPECT_EQ(frames(), before);
  EXPECT_EQ(newest().edition, 0u);
}

TEST_F(EditedWorldTest, ListsTheEntities) {
  StartAndHold();
  Ask(control::Entities());
  ASSERT_EQ(replies.back().entities.size(), 2u);
  EXPECT_EQ(replies.back().entities[1].name, "r1");
  EXPECT_EQ(replies.back().entities[1].kind, EntityKind::kRobot);
  EXPECT_EQ(replies.back().entities[1].X_WE, (Pose{0.0, 10.0, 0.0, 0.0}));
  Ask(control::Entities{.name = "r1"});
  ASSERT_EQ(replies.back().entities.size(), 1u);
  EXPECT_EQ(replies.back().entities[0].name, "r1");
  Ask(control::Entities{.name = "nobody"});
  EXPECT_EQ(replies.back().problem, "the world has no entity 'nobody'");
}

TEST_F(EditedWorldTest, ListsTheAgentsOfRobots) {
  StartAndHold();
  Ask(control::Play());
  now += 0.2;
  Propose(1);
  now += 0.3;
  Propose(2);
  coordinator->OnAgentGone(2, now);
  Ask(control::Entities());
  ASSERT_EQ(replies.back().entities.size(), 2u);
  const std::optional<AgentReport> first = replies.back().entities[0].agent;
  const std::optional<AgentReport> second = replies.back().entities[1].agent;
  ASSERT_TRUE(first && second);
  EXPECT_TRUE(first->present);
  EXPECT_NEAR(first->answer_seconds, 0.2, 1e-9);
  EXPECT_EQ(first->times_last, 0u);
  EXPECT_FALSE(second->present);
  EXPECT_NEAR(second->answer_seconds, 0.5, 1e-9);
  EXPECT_EQ(second->times_last, 1u);
}

TEST_F(EditedWorldTest, ContinuesWithoutTheAgentOfADeletedRobot) {
  StartAndHold();
  Ask(control::Delete{.name = "r0"});
  ASSERT_EQ(endpoint.sessions.size(), 1u);
  EXPECT_EQ(endpoint.sessions[0].world_edition, 1u);
  EXPECT_TRUE(endpoint.sessions[0].begun);
  EXPECT_TRUE(endpoint.sessions[0].world->models[0].removed);
  EXPECT_EQ(newest().world_edition, 1u);
  AnswerPaused(2);
  EXPECT_TRUE(replies.back().done);
  coordinator->OnAgentGone(1, now);
  EXPECT_EQ(coordinator->MakeStatus(now).robots, 1u);
  EXPECT_EQ(coordinator->MakeStatus(now).agents, 1u);
  Ask(control::Play());
  Propose(2);
  EXPECT_EQ(tick(), 1u);
  EXPECT_THAT(coordinator->MakeSummary().lost, IsEmpty());
}

TEST_F(EditedWorldTest, WaitsForTheAgentOfASpawnedRobot) {
  StartAndHold();
  Spawn("new");
  EXPECT_THAT(coordinator->DrainNewRobots(), testing::ElementsAre("new"));
  AnswerPaused(1);
  AnswerPaused(2);
  EXPECT_THAT(replies, IsEmpty());
  EXPECT_THAT(coordinator->MakeStatus(now).waiting_for, testing::ElementsAre("new"));
  Join(3, {"new"});  // with the world before
  EXPECT_THAT(endpoint.admissions, testing::SizeIs(2)) << "no answer: the new session is on its way to it";
  JoinNewest(3, "new");
  EXPECT_TRUE(endpoint.admissions.back().admitted);
  EXPECT_THAT(replies, IsEmpty());
  AnswerPaused(3);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_TRUE(replies[0].done) << replies[0].problem;
  ASSERT_EQ(replies[0].entities.size(), 1u);
  EXPECT_EQ(replies[0].entities[0].name, "new");
  Ask(control::Play());
  for (const AgentId agent : {1, 2, 3}) Propose(agent);
  EXPECT_EQ(tick(), 1u);
  EXPECT_GT(Travel(2), 0.0);
}

TEST_F(EditedWorldTest, RevokesASpawnWhoseAgentDoesNotJoin) {
  StartAndHold();
  Spawn("new");
  AnswerPaused(1);
  AnswerPaused(2);
  Wait(9.0);
  EXPECT_THAT(replies, IsEmpty());
  Wait(2.0);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].problem, "no agent joined for new within 10 s");
  EXPECT_EQ(newest().edition, 2u);
  EXPECT_TRUE(endpoint.sessions.back().world->models[2].removed);
  AnswerPaused(1);
  AnswerPaused(2);
  Ask(control::Play());
  Propose(1);
  Propose(2);
  EXPECT_EQ(tick(), 1u);
}

TEST_F(EditedWorldTest, SpawnsUnderAFreeNameIfAsked) {
  StartAndHold();
  control::Spawn spawn{.name = "r0", .pose = {0.0, -5.0, 0.0, 0.0}};
  spawn.rename = true;
  Ask(spawn, std::make_shared<const WorldDescription>(PlaneWorld(1)));
  EXPECT_THAT(coordinator->DrainNewRobots(), testing::ElementsAre("r00"));
  EXPECT_EQ(endpoint.sessions.back().world->models.back().name, "r00");
}

TEST_F(EditedWorldTest, AResetRestoresDeletedRobots) {
  StartAndHold();
  Ask(control::Delete{.name = "r0"});
  AnswerPaused(2);
  Ask(control::Reset());
  EXPECT_THAT(coordinator->DrainNewRobots(), testing::ElementsAre("r0"));
  EXPECT_EQ(newest().fresh_edition, 2u);
  AnswerPaused(2);
  JoinNewest(5, "r0");
  ProposalMessage paused = ProposalOf(5, 0.0);
  paused.proposals.clear();
  paused.paused = true;
  coordinator->OnProposal(paused, now);
  ASSERT_EQ(replies.size(), 2u);
  EXPECT_TRUE(replies[1].done) << replies[1].problem;
}

TEST_F(EditedWorldTest, KeepsTheAgentsOfRobotsThatTheLoadedWorldAlsoHas) {
  StartAndHold();
  control::LoadWorld load;
  load.source = "other.world";
  WorldDescription other = PlaneWorld(2);
  std::swap(other.robots[0].name, other.robots[1].name);
  std::swap(other.models[0].name, other.models[1].name);
  Ask(load, std::make_shared<const WorldDescription>(other));
  EXPECT_THAT(coordinator->DrainNewRobots(), IsEmpty());
  EXPECT_EQ(endpoint.sessions.back().world, other);
  AnswerPaused(1);
  AnswerPaused(2);
  EXPECT_TRUE(replies.back().done);
  Ask(control::Play());
  ProposalMessage first = ProposalOf(1, 2.0);
  first.proposals[0].robot = RobotId(1);
  ProposalMessage second = ProposalOf(2, 1.0);
  second.proposals[0].robot = RobotId(0);
  coordinator->OnProposal(first, now);
  coordinator->OnProposal(second, now);
  EXPECT_EQ(tick(), 1u);
  EXPECT_DOUBLE_EQ(Travel(0), 0.1);
  EXPECT_DOUBLE_EQ(Travel(1), 0.2);
  Ask(control::Reset());
  EXPECT_EQ(coordinator->scene()->world(), other);
}

TEST_F(EditedWorldTest, WaitsForAgentsWhenALoadedWorldHasOnlyNewRobots) {
  StartAndHold();
  Wait(2.0 * options.start_timeout_seconds);
  WorldDescription other = PlaneWorld(2);
  for (std::size_t i = 0; i < 2; ++i) other.robots[i].name = other.models[i].name = "other" + std::to_string(i);
  Ask(control::LoadWorld(), std::make_shared<const WorldDescription>(other));
  EXPECT_THAT(coordinator->DrainNewRobots(), testing::ElementsAre("other0", "other1"));
  Wait(0.5 * options.start_timeout_seconds);
  EXPECT_THAT(replies, IsEmpty());
  JoinNewest(3, "other0");
  JoinNewest(4, "other1");
  AnswerPaused(3);
  AnswerPaused(4);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_TRUE(replies[0].done) << replies[0].problem;
}

TEST_F(EditedWorldTest, ContinuesAfterALoadWhoseAgentsDoNotJoin) {
  StartAndHold();
  Ask(control::LoadWorld(), std::make_shared<const WorldDescription>(PlaneWorld(3)));
  AnswerPaused(1);
  AnswerPaused(2);
  Wait(11.0);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].problem, "no agent joined for r2 within 10 s");
  Ask(control::Play());
  Propose(1);
  Propose(2);
  EXPECT_EQ(tick(), 1u) << "a robot without an agent stands still";
}

TEST_F(EditedWorldTest, AnAgentThatWasLostWhenTheWorldChangedIsUnknown) {
  StartAndHold();
  coordinator->OnAgentGone(2, now);
  Ask(control::SetPose{.name = "r0", .pose = {1.0, 0.0, 0.0, 0.0}});
  AnswerPaused(1);
  EXPECT_TRUE(replies.back().done);
  Join(2);
  AnswerPaused(2);
  EXPECT_EQ(coordinator->MakeStatus(now).agents, 2u) << "it may rejoin while the description is the same";
  coordinator->OnAgentGone(2, now);
  Spawn("new");
  AnswerPaused(2);
  EXPECT_EQ(coordinator->MakeStatus(now).agents, 1u);
  EXPECT_THAT(Events(), testing::Contains("proposal_rejected"));
  JoinNewest(4, "r1");
  EXPECT_TRUE(endpoint.admissions.back().admitted);
}

TEST_F(EditTest, AnnouncesTheSessionAgainToARivalThatCannotKnowThatTheRunHasBegun) {
  MakeAndStart(1);
  SessionMessage rival;
  rival.run = kRun + 1;
  coordinator->OnRivalService(rival, now);
  ASSERT_EQ(endpoint.sessions.size(), 1u);
  EXPECT_TRUE(endpoint.sessions[0].begun);
  EXPECT_EQ(endpoint.sessions[0].world, scene->world());
}

}  // namespace
}  // namespace troupe::test
