// Real agents and the real world service, while the world is edited.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/support/controlled_run.h"
#include "tests/support/edits.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"

namespace troupe::test {
namespace {

using testing::ElementsAreArray;

std::vector<std::uint64_t> Slice(const std::vector<std::uint64_t>& hashes, std::size_t begin, std::size_t end) {
  return {hashes.begin() + static_cast<std::ptrdiff_t>(begin), hashes.begin() + static_cast<std::ptrdiff_t>(end)};
}

TEST(EditedRunTest, AResetGivesTheSameHashesAgain) {
  for (const std::size_t packing : {1, 4}) {
    ControlledRun run(Yard(), {.packing = packing});
    run.Step(100);
    EXPECT_TRUE(run.Ask(control::Reset()).done);
    run.Step(100);
    const std::vector<std::uint64_t> hashes = run.Hashes();
    ASSERT_EQ(hashes.size(), 202u);
    EXPECT_THAT(Slice(hashes, 101, 202), ElementsAreArray(Slice(hashes, 0, 101)));
    EXPECT_NE(hashes[100], hashes[0]);
    EXPECT_EQ(ValueOf(run.Finish()).rejected, 0u);
  }
}

TEST(EditedRunTest, AResetWhileItPlaysGivesTheSameHashesAsWell) {
  ControlledRun run(Yard(2), {});
  EXPECT_TRUE(run.Ask(control::Play()).done);
  EXPECT_TRUE(run.Ask(control::Reset()).done);
  ASSERT_TRUE(run.Ask(control::Reset()).done);
  EXPECT_TRUE(run.Ask(control::Pause()).done);
  std::vector<std::vector<std::uint64_t>> passes;
  for (const FrameMessage& frame : run.frames()) {
    passes.resize(frame.edition + 1);
    passes.back().push_back(frame.state_hash);
    EXPECT_EQ(frame.state.tick + 1, passes.back().size());
  }
  ASSERT_EQ(passes.size(), 3u);
  for (std::size_t tick = 0; tick < std::min(passes[0].size(), passes[1].size()); ++tick) {
    EXPECT_EQ(passes[0][tick], passes[1][tick]);
  }
}

TEST(EditedRunTest, FaultsOfTheTransportChangeNoHash) {
  ControlledRun run(Yard(3), {.faults = {.loss = 0.05,
                                         .duplicate = 0.1,
                                         .reorder = 0.1,
                                         .delay_probability = 0.1,
                                         .delay_seconds = 0.002,
                                         .seed = 5}});
  run.Step(30);
  EXPECT_TRUE(run.Ask(control::Delete{.name = "r2"}).done);
  run.Step(10);
  EXPECT_TRUE(run.Ask(control::Reset()).done);
  run.Step(30);
  const std::vector<std::uint64_t> hashes = run.Hashes();
  ASSERT_EQ(hashes.size(), 73u);
  EXPECT_THAT(Slice(hashes, 42, 73), ElementsAreArray(Slice(hashes, 0, 31)));
}

TEST(EditedRunTest, TheAgentOfADeletedRobotLeavesAndAResetNeedsANewOne) {
  for (const std::size_t packing : {1, 3}) {
    ControlledRun run(Yard(3), {.packing = packing});
    run.Step(20);
    ASSERT_TRUE(run.Ask(control::Delete{.name = "r1"}).done);
    if (packing == 1) {
      EXPECT_EQ(ValueOf(run.AwaitAgentOf("r1")), AgentEnd::kRunOver);
    }
    run.Step(20);
    EXPECT_EQ(run.frame().state.robots[1].twist, Twist{});
    const ControlReply reset = run.Ask(control::Reset());
    ASSERT_TRUE(reset.done) << reset.problem;
    run.Step(20);
    const std::vector<std::uint64_t> hashes = run.Hashes();
    ASSERT_EQ(hashes.size(), 21u + 21u + 21u);
    EXPECT_THAT(Slice(hashes, 42, 63), ElementsAreArray(Slice(hashes, 0, 21)));
    const RunSummary summary = ValueOf(run.Finish());
    EXPECT_EQ(summary.rejected, 0u);
    EXPECT_TRUE(summary.lost.empty());
  }
}

control::Request SpawnScout(const std::string& name, const Pose& pose) {
  control::Spawn request{.name = name, .pose = pose};
  request.source = "scout";
  return request;
}

TEST(EditedRunTest, ASpawnWithoutAnAgentIsUndone) {
  const DefinitionFile definitions;
  ControlledRun run(Yard(2),
                    {.start_timeout_seconds = 1.0, .start_new_agents = false, .world_file = definitions.path()});
  const ControlReply reply = run.Ask(SpawnScout("late", {0.0, 20.0, 0.0, 0.0}));
  EXPECT_EQ(reply.problem, "no agent joined for late within 1 s");
  run.Step(5);
  EXPECT_EQ(run.frame().edition, 2u);
  EXPECT_EQ(run.Ask(control::Entities()).entities.size(), 6u);
}

TEST(EditedRunTest, TheSameEditsGiveTheSameHashesForAnyPacking) {
  const DefinitionFile definitions;
  std::vector<std::uint64_t> expected;
  for (const std::size_t packing : {1, 2, 4}) {
    ControlledRun run(Yard(4), {.packing = packing, .world_file = definitions.path()});
    const auto edit = [&](const control::Request& request) {
      const ControlReply reply = run.Ask(request);
      EXPECT_TRUE(reply.done) << reply.problem;
      run.Step(10);
    };
    run.Step(10);
    edit(control::SetPose{.name = "r0", .pose = {0.0, 20.0, 0.0, 0.0}});
    edit(control::Delete{.name = "r1"});
    edit(SpawnScout("late", {3.0, 20.0, 0.0, 1.0}));
    edit(SpawnScout("r1", {6.0, 20.0, 0.0, 2.0}));
    edit(control::SetPose{.name = "wall3", .pose = {0.0, 30.0, 0.0, 0.0}});
    edit(control::Reset());
    EXPECT_EQ(ValueOf(run.Finish()).rejected, 0u);
    if (expected.empty()) expected = run.Hashes();
    EXPECT_EQ(run.Hashes(), expected);
  }
}

TEST(EditedRunTest, ALoadedWorldRunsAsItDoesByItself) {
  const DefinitionFile definitions;
  const std::string path = definitions.path() + ".world";
  std::ofstream(path) << "define scout position ( size [0.3 0.3 0.2] ctrl \"wander\" )\n"
                         "scout ( name \"r1\" pose [3 0 0 0] )\nscout ( name \"other\" pose [0 3 0 0] )\n";
  ControlledRun plain(LoadWorld(path).value().world, {});
  plain.Step(30);
  ControlledRun run(Yard(2), {});
  run.Step(10);
  control::LoadWorld load;
  load.source = path;
  const ControlReply reply = run.Ask(load);
  EXPECT_TRUE(reply.done) << reply.problem;
  run.Step(30);
  EXPECT_EQ(run.Hashes(11), plain.Hashes());
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace troupe::test
