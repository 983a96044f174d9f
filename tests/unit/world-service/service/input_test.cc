// Requests that are inputs of a tick: no pause, no edition; they are recorded and journalled.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "common/model/lane_rules.h"
#include "recording/recording.h"
#include "tests/support/controlled_run.h"
#include "tests/support/edits.h"
#include "tests/support/files.h"
#include "tests/support/small_world.h"
#include "tests/unit/world-service/service/coordinator_fixture.h"
#include "world-service/replay/replayed_world.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

// Keeps what an observer is told of inputs.
class InputLog final : public RunObserver {
 public:
  Status OnCommit(const CommittedTick& tick, const RunProgress& progress) override {
    entered.insert(entered.end(), tick.inputs.begin(), tick.inputs.end());
    waiting = progress.inputs;
    return {};
  }
  Status OnProgress(const RunProgress& progress) override {
    waiting = progress.inputs;
    return {};
  }

  std::vector<Input> entered;
  std::vector<Input> waiting;
};

class InputTest : public CoordinatorTest {
 protected:
  InputTest() { observers.push_back(&log_); }

  ControlReply SetTwist(const std::string& robot, double vx) {
    return Ask(control::SetTwist{.name = robot, .twist = {vx, 0.0, 0.0}});
  }

  InputLog log_;
};

TEST_F(InputTest, EntersTheNextStepWithoutAPause) {
  MakeAndStart(2);
  const ControlReply reply = SetTwist("r1", 2.5);
  EXPECT_TRUE(reply.done) << reply.problem;
  EXPECT_EQ(reply.state, RunState::kPlaying);
  EXPECT_THAT(log_.waiting, testing::ElementsAre(Input{RobotId(1), TwistOrder{{2.5, 0.0, 0.0}}}));
  Propose(1);
  Propose(2, 0.0);
  ASSERT_EQ(tick(), 1u);
  EXPECT_EQ(endpoint.frames.back().state.robots[1].twist.vx, 2.5);
  EXPECT_TRUE(log_.waiting.empty());
  EXPECT_THAT(log_.entered, testing::ElementsAre(Input{RobotId(1), TwistOrder{{2.5, 0.0, 0.0}}}));
  EXPECT_TRUE(std::none_of(endpoint.frames.begin(), endpoint.frames.end(),
                           [](const FrameMessage& frame) { return frame.paused || frame.edition > 0; }));
  Propose(1);
  Propose(2, 0.0);
  EXPECT_EQ(log_.entered.size(), 1u) << "once";
}

TEST_F(InputTest, RefusesWhatTheWorldDoesNotHave) {
  MakeAndStart(1);
  EXPECT_THAT(SetTwist("nobody", 1.0).problem, HasSubstr("nobody"));
  EXPECT_THAT(SetTwist("r0", 1e6).problem, HasSubstr("cannot have"));
  EXPECT_THAT(Ask(control::Door{.name = "gate", .opening = 1.0}).problem, HasSubstr("no door 'gate'"));
  EXPECT_THAT(Ask(control::Lift{.name = "up", .floor = "L1"}).problem, HasSubstr("no lift 'up'"));
  EXPECT_THAT(Ask(control::Lane{.from = "a", .to = "b"}).problem, HasSubstr("no lane from 'a' to 'b'"));
  EXPECT_THAT(Ask(control::Zone{.name = "wet"}).problem, HasSubstr("no zone 'wet'"));
  EXPECT_TRUE(log_.waiting.empty());
}

TEST_F(InputTest, IsForgottenByAResetAndByTheEndOfItsRobot) {
  options.start_paused = true;
  MakeAndStart(2);
  const auto answer = [&] {
    for (AgentId agent : {1, 2}) {
      ProposalMessage message = ProposalOf(agent, 0.0);
      message.proposals.clear();
      message.paused = true;
      coordinator->OnProposal(message, now);
    }
  };
  answer();
  SetTwist("r0", 1.0);
  SetTwist("r1", 1.0);
  ASSERT_EQ(log_.waiting.size(), 2u);
  Ask(control::Delete{.name = "r1"});
  EXPECT_THAT(log_.waiting, testing::ElementsAre(Input{RobotId(0), TwistOrder{{1.0, 0.0, 0.0}}}));
  answer();
  Ask(control::Reset());
  EXPECT_TRUE(log_.waiting.empty());
}

TEST(InputsOfARun, SwitchTheLightsOfRobots) {
  SmallWorld world;
  for (const char* name : {"r0", "r1"}) {
    const RobotId robot = world.AddRobot(name, {0.0, name[1] == '0' ? 0.0 : 2.0, 0.0, 0.0});
    world.SetController(robot, "wander");
    for (const char* light : {"left", "right"}) {
      world.AddPart(robot, light, {0.0, 0.0, 0.4, 0.0}, 0.1, 0.1, {0.0, 0.1}).blinking = {2'000, 1'000, false};
    }
  }
  ControlledRun run(world.world(), {});
  run.Step(1);
  EXPECT_TRUE(run.Ask(control::Light{.name = "r1.right", .on = true}).done);
  run.Step(1);
  const auto only_last = std::vector<LightState>{{false}, {false}, {false}, {true}};
  EXPECT_EQ(run.frame().state.lights, only_last);
  EXPECT_EQ(run.frame().edition, 0u);
  EXPECT_THAT(run.Ask(control::Light{.name = "r1"}).problem, HasSubstr("no light 'r1'"));
  EXPECT_TRUE(run.Ask(control::Light{.name = "r1.right", .on = false}).done);
  run.Step(1);
  EXPECT_EQ(run.frame().state.lights, std::vector<LightState>(4, {false}));
}

// Doors of a building, requested in a run whose agents are threads. The recording steps to the same hashes.
TEST(InputsOfARun, AreRecordedAndReplayed) {
  TemporaryFolder folder;
  const std::string path = folder.Path("run.mcap");
  std::vector<std::uint64_t> hashes;
  {
    ControlledRun run(Scenario("../sites/guesthouse_lanes.json"), {.packing = 2, .outputs = {.record = path}});
    run.Step(5);
    EXPECT_TRUE(run.Ask(control::Door{.name = "room_1_door", .opening = 1.0}).done);
    run.Step(1);
    EXPECT_EQ(run.frame().state.doors[*FindDoor(Scenario("../sites/guesthouse_lanes.json"), "room_1_door")].target,
              1.0);
    EXPECT_TRUE(run.Ask(control::Lift{.name = "guest_lift", .floor = "L2"}).done);
    const LaneGraph graph = Scenario("../sites/guesthouse_lanes.json").lane_graphs[0];
    const WholeLane lane = WholeLanesOf(graph)[0];
    const auto name = [&](std::size_t vertex) { return NameOfVertex(graph, vertex); };
    EXPECT_TRUE(run.Ask(control::Lane{.from = name(lane.end), .to = name(lane.start), .speed_limit = 0.0}).done);
    run.Step(1);
    ASSERT_THAT(run.frame().state.lane_rules, testing::Not(testing::IsEmpty()));
    EXPECT_EQ(run.frame().state.lane_rules[0], (LaneRule{0, 0.0}));
    run.Step(20);
    EXPECT_EQ(run.frame().edition, 0u);
    hashes = run.Hashes();
    ASSERT_TRUE(run.Finish().ok());
  }
  const Result<Recording> recording = Recording::Open(path);
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  Result<ReplayCursor> cursor = ReplayCursor::At(recording.value(), 0);
  ASSERT_TRUE(cursor.ok()) << cursor.error().message;
  std::size_t inputs = 0;
  std::size_t states = 0;
  for (;; ++states) {
    const Result<const RecordedTick*> next = cursor.value().Next();
    ASSERT_TRUE(next.ok()) << next.error().message;
    if (next.value() == nullptr) break;
    inputs += next.value()->inputs.size();
    const Status followed = cursor.value().Advance();
    ASSERT_TRUE(followed.ok()) << followed.error().message;
    EXPECT_EQ(cursor.value().world().state_hash(), hashes.at(states));
  }
  EXPECT_EQ(inputs, 3u);
  EXPECT_EQ(states, hashes.size());
}

}  // namespace
}  // namespace troupe::test
