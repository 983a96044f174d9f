// Agents that are replaced during a run: with on_agent_loss rebuild the new ones remember what the old ones knew, and
// the hashes are those of a run without a loss.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <random>

#include "tests/support/controlled_run.h"
#include "tests/support/edits.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "worldfile/load_world.h"

namespace troupe::test {
namespace {

using testing::ElementsAreArray;
using testing::IsEmpty;

// With controllers that depend on all ticks before.
WorldDescription CountingYard(int robots) {
  WorldDescription world = Yard(robots);
  for (std::size_t i = 0; i < world.robots.size(); i += 2) world.robots[i].controller.name = COUNTING_CONTROLLER;
  return world;
}

// Lets the run play up to a tick, and pauses it. Calls `meanwhile` again and again.
template <typename Meanwhile>
void PlayTo(ControlledRun& run, Tick tick, const Meanwhile& meanwhile) {
  EXPECT_TRUE(run.Ask(control::Play()).done);
  while (run.frame().state.tick < tick) meanwhile();
  EXPECT_TRUE(run.Ask(control::Pause()).done);
}

// The first hashes of both are equal.
void ExpectSameRun(const std::vector<std::uint64_t>& hashes, const std::vector<std::uint64_t>& expected,
                   std::size_t least) {
  const std::size_t common = std::min(hashes.size(), expected.size());
  ASSERT_GE(common, least);
  for (std::size_t i = 0; i < common; ++i) ASSERT_EQ(hashes[i], expected[i]) << "state " << i;
}

struct LossyWorld {
  std::string name;
  WorldDescription (*make)();
  std::size_t packing = 1;
};

class RebuiltWorldTest : public testing::TestWithParam<LossyWorld> {};

TEST_P(RebuiltWorldTest, LossesAtAnyTimeChangeNoHash) {
  const WorldDescription world = GetParam().make();
  std::vector<std::uint64_t> undisturbed;
  {
    ControlledRun run(world, {.packing = GetParam().packing});
    run.Step(400);
    undisturbed = run.Hashes();
  }
  ControlledRun run(world, {.packing = GetParam().packing, .on_agent_loss = OnAgentLoss::kRebuild, .speed = 20.0});
  std::mt19937 random(7);
  int replaced = 0;
  const auto replace = [&] {
    run.ReplaceAgentOf(world.robots[random() % world.robots.size()].name);
    ++replaced;
    const Tick until = run.frame().state.tick + random() % 40;
    while (run.frame().state.tick < until) std::this_thread::yield();
  };
  PlayTo(run, 150, replace);
  // In a pause, too: the memory includes the odometry of the paused state.
  run.ReplaceAgentOf(world.robots[0].name);
  run.Step(3);
  run.ReplaceAgentOf(world.robots[0].name);
  run.Step(1);
  PlayTo(run, 300, replace);
  EXPECT_GT(replaced, 5);
  ExpectSameRun(run.Hashes(), undisturbed, 300);
  const RunSummary summary = ValueOf(run.Finish());
  EXPECT_EQ(summary.rejected, 0u);
  EXPECT_THAT(summary.lost, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Worlds, RebuiltWorldTest,
                         testing::Values(LossyWorld{"yard", [] { return CountingYard(4); }},
                                         LossyWorld{"yardPacked", [] { return CountingYard(6); }, 3},
                                         LossyWorld{"demo", [] { return Scenario("demo.json"); }},
                                         LossyWorld{"relay", [] { return Scenario("relay.json"); }},
                                         LossyWorld{"stacking", [] { return Scenario("stacking.json"); }, 2}),
                         [](const testing::TestParamInfo<LossyWorld>& world) { return world.param.name; });

TEST(RebuiltRunTest, FaultsOfTheTransportChangeNoHash) {
  const WorldDescription world = CountingYard(3);
  std::vector<std::uint64_t> undisturbed;
  {
    ControlledRun run(world, {});
    run.Step(300);
    undisturbed = run.Hashes();
  }
  ControlledRun run(
      world,
      {.faults =
           {.loss = 0.1, .duplicate = 0.1, .reorder = 0.1, .delay_probability = 0.1, .delay_seconds = 0.002, .seed = 5},
       .on_agent_loss = OnAgentLoss::kRebuild});
  for (const char* robot : {"r0", "r1", "r2"}) {
    run.Step(50);
    run.ReplaceAgentOf(robot);
  }
  run.Step(50);
  ExpectSameRun(run.Hashes(), undisturbed, 200);
}

// Edits of all kinds; `between` is called after each.
template <typename Between>
void RunWithEdits(ControlledRun& run, const Between& between) {
  const auto ask = [&](const control::Request& request) {
    const ControlReply reply = run.Ask(request);
    EXPECT_TRUE(reply.done) << reply.problem;
    between();
    run.Step(17);
    between();
  };
  run.Step(20);
  between();
  ask(control::SetPose{.name = "r1", .pose = {0.5, 3.0, 0.0, 1.0}});
  control::Spawn spawn{.name = "late", .pose = {-2.0, 2.0, 0.0, 0.5}};
  spawn.source = "scout";
  ask(spawn);
  ask(control::Delete{.name = "r2"});
  control::Reset time;
  time.scopes = kResetTime;
  ask(time);
  ask(control::SetPose{.name = "late", .pose = {-1.0, 3.0, 0.0, -1.0}});
  ask(control::Reset());
  ask(spawn);
  ask(control::Delete{.name = "late"});
  ask(spawn);  // another robot of the same name
}

TEST(RebuiltRunTest, EditsAreRemembered) {
  const DefinitionFile file;
  std::vector<std::uint64_t> undisturbed;
  {
    ControlledRun run(CountingYard(4), {.world_file = file.path()});
    RunWithEdits(run, [] {});
    undisturbed = run.Hashes();
  }
  for (const bool all : {false, true}) {
    ControlledRun run(CountingYard(4), {.world_file = file.path(), .on_agent_loss = OnAgentLoss::kRebuild});
    std::mt19937 random(all ? 3 : 4);
    RunWithEdits(run, [&] {
      const ControlReply reply = run.Ask(control::Entities());
      for (const EntityReport& entity : reply.entities) {
        if (entity.kind == EntityKind::kRobot && (all || random() % 4 == 0)) run.ReplaceAgentOf(entity.name);
      }
    });
    EXPECT_THAT(run.Hashes(), ElementsAreArray(undisturbed));
    EXPECT_EQ(ValueOf(run.Finish()).rejected, 0u);
  }
}

// With other settings a new agent knows nothing, as its robots' states show.
TEST(RebuiltRunTest, WithoutRebuildTheMemoryIsLost) {
  const WorldDescription world = CountingYard(3);
  std::vector<std::uint64_t> undisturbed;
  {
    ControlledRun run(world, {});
    run.Step(200);
    undisturbed = run.Hashes();
  }
  ControlledRun run(world, {.on_agent_loss = OnAgentLoss::kPause});
  run.Step(100);
  for (const char* robot : {"r0", "r1", "r2"}) run.ReplaceAgentOf(robot);
  run.Step(100);
  EXPECT_NE(run.Hashes(), undisturbed);
}

}  // namespace
}  // namespace troupe::test
