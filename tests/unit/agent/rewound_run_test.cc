// Runs that are set back to an earlier tick: they continue as before, with the memory of their controllers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/support/controlled_run.h"
#include "tests/support/edits.h"
#include "tests/support/yard.h"
#include "world-service/replay/run_replay.h"
#include "worldfile/load_world.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

// With controllers that depend on all ticks before.
WorldDescription CountingYard() {
  WorldDescription world = Yard(4);
  for (std::size_t i = 0; i < world.robots.size(); i += 2) world.robots[i].controller.name = COUNTING_CONTROLLER;
  return world;
}

class Files {
 public:
  Files() {
    std::filesystem::create_directories(folder_);
    std::ofstream(definitions()) << "define scout position ( size [0.3 0.3 0.2] ctrl \"wander\" )\n";
  }
  ~Files() { std::filesystem::remove_all(folder_); }
  std::string definitions() const { return folder_ + "/robots.world"; }
  std::string recording() const { return folder_ + "/run.mcap"; }

 private:
  const std::string folder_ =
      (std::filesystem::temp_directory_path() / ("rewound-run-" + std::to_string(getpid()))).string();
};

OutputFiles Record(const std::string& path, std::uint64_t keyframe_interval) {
  OutputFiles files;
  files.record = path;
  files.keyframe_interval = keyframe_interval;
  return files;
}

void Rewind(ControlledRun& run, Tick tick) {
  const ControlReply reply = run.Ask(ControlCommand::kRewind, tick);
  ASSERT_TRUE(reply.done) << reply.problem;
  EXPECT_EQ(reply.tick, tick);
  EXPECT_EQ(run.frame().state.tick, tick);
}

// Steps of the run to be followed by the same ones, from a tick on.
void ExpectSame(ControlledRun& run, const std::vector<std::uint64_t>& hash_of_tick, Tick to) {
  const Tick from = run.frame().state.tick;
  ASSERT_EQ(run.frame().state_hash, hash_of_tick[from]) << "after the rewind to tick " << from;
  if (from == to) return;
  const std::size_t begin = run.frames().size();
  run.Step(to - from);
  const std::vector<std::uint64_t> hashes = run.Hashes(begin);
  ASSERT_EQ(hashes.size(), to - from);
  for (Tick tick = from + 1; tick <= to; ++tick) {
    ASSERT_EQ(hashes[tick - from - 1], hash_of_tick[tick]) << "tick " << tick << " after the rewind to " << from;
  }
}

void ExpectEqualReplay(const std::string& path) {
  const Result<Recording> recording = Recording::Open(path);
  ASSERT_TRUE(recording.ok()) << recording.error().ToString();
  ReplayOptions options;
  options.compare_events = true;
  const Result<ReplayReport> report = RunReplay(recording.value(), options).Run();
  ASSERT_TRUE(report.ok()) << report.error().ToString();
  EXPECT_EQ(report.value().difference, std::nullopt);
  EXPECT_EQ(report.value().damage, std::nullopt);
  EXPECT_GT(report.value().states, 100u);
}

struct World {
  std::string name;
  WorldDescription (*make)();
  std::size_t packing = 1;
};

class RewoundWorldTest : public testing::TestWithParam<World> {};

TEST_P(RewoundWorldTest, ItContinuesAsBeforeFromAnyTick) {
  const Files files;
  {
    const WorldDescription world = GetParam().make();
    ControlledRun run(world, {.packing = GetParam().packing, .outputs = Record(files.recording(), 25)});
    run.Step(160);
    const std::vector<std::uint64_t> hashes = run.Hashes();
    for (const Tick tick : {60, 159, 1, 0, 100, 160}) {
      Rewind(run, tick);
      ExpectSame(run, hashes, 160);
    }
    Rewind(run, 120);
    Rewind(run, 30);
    run.Step(10);
    Rewind(run, 35);
    run.ReplaceAgentOf(world.robots[0].name);
    const ControlReply future = run.Ask(ControlCommand::kRewind, 36);
    EXPECT_FALSE(future.done);
    EXPECT_THAT(future.problem, HasSubstr("found tick 36, expected at most 35"));
    const Result<RunSummary> summary = run.Finish();
    ASSERT_TRUE(summary.ok()) << summary.error().ToString();
    EXPECT_EQ(summary.value().rejected, 0u);
  }
  ExpectEqualReplay(files.recording());
}

INSTANTIATE_TEST_SUITE_P(Worlds, RewoundWorldTest,
                         testing::Values(World{"yard", CountingYard}, World{"yardPacked", CountingYard, 3},
                                         World{"relay", [] { return Scenario("relay.json"); }},
                                         World{"stacking", [] { return Scenario("stacking.json"); }, 2}),
                         [](const testing::TestParamInfo<World>& world) { return world.param.name; });

TEST(RewoundRunTest, PlayingRunsRewindAndPlayOn) {
  ControlledRun run(CountingYard(), {.can_rewind = true});
  run.Step(100);
  const std::vector<std::uint64_t> hashes = run.Hashes();
  EXPECT_TRUE(run.Ask(ControlCommand::kPlay).done);
  const ControlReply reply = run.Ask(ControlCommand::kRewind, 50);
  ASSERT_TRUE(reply.done) << reply.problem;
  const std::size_t begin = run.frames().size();
  while (run.frames().size() < begin + 20) std::this_thread::yield();
  EXPECT_TRUE(run.Ask(ControlCommand::kPause).done);
  const std::vector<FrameMessage> frames = run.frames();
  const Edition edition = frames.back().edition;
  for (const FrameMessage& frame : frames) {
    if (frame.edition == edition && frame.state.tick <= 100) {
      EXPECT_EQ(frame.state_hash, hashes[frame.state.tick]) << frame.state.tick;
    }
  }
}

TEST(RewoundRunTest, FaultsOfTheTransportChangeNoHash) {
  ControlledRun run(
      CountingYard(),
      {.faults =
           {.loss = 0.1, .duplicate = 0.1, .reorder = 0.1, .delay_probability = 0.1, .delay_seconds = 0.002, .seed = 5},
       .can_rewind = true});
  run.Step(40);
  const std::vector<std::uint64_t> hashes = run.Hashes();
  for (const Tick tick : {20, 30}) {
    Rewind(run, tick);
    ExpectSame(run, hashes, 40);
  }
}

// Spawned and deleted robots return, or are gone, as at that tick; so do resets and their pasts.
TEST(RewoundRunTest, EditsArePartOfThePast) {
  const Files files;
  {
    ControlledRun run(CountingYard(), {.outputs = Record(files.recording(), 10), .world_file = files.definitions()});
    const auto ask = [&](const ControlRequest& request) {
      const ControlReply reply = run.Ask(request);
      ASSERT_TRUE(reply.done) << reply.problem;
    };
    ControlRequest spawn = Request(ControlCommand::kSpawn, "late", {-2.0, 2.0, 0.0, 0.5});
    spawn.source = "scout";
    run.Step(20);
    ask(spawn);  // at tick 20
    run.Step(20);
    ask(Request(ControlCommand::kDelete, "r1"));  // at tick 40
    run.Step(20);
    ask(Request(ControlCommand::kSetPose, "r2", {0.5, 3.0, 0.0, 1.0}));  // at tick 60
    run.Step(40);
    std::vector<std::uint64_t> hashes;  // of the last state of each tick
    for (const FrameMessage& frame : run.frames()) {
      hashes.resize(frame.state.tick + 1);
      hashes.back() = frame.state_hash;
    }
    Rewind(run, 75);
    ExpectSame(run, hashes, 100);
    Rewind(run, 50);
    EXPECT_EQ(run.Ask(ControlCommand::kEntities).entities.size(), 4u + 4u);  // walls, and r0, r2, r3, late
    run.Step(10);
    ask(Request(ControlCommand::kSetPose, "r2", {0.5, 3.0, 0.0, 1.0}));
    ExpectSame(run, hashes, 90);
    Rewind(run, 30);  // r1 has an agent again
    run.Step(10);
    ask(Request(ControlCommand::kDelete, "r1"));
    ExpectSame(run, hashes, 60 - 1);
    Rewind(run, 10);  // nothing is spawned
    run.Step(10);
    ask(spawn);
    ExpectSame(run, hashes, 39);
    // Behind a reset the past begins anew.
    ask(Request(ControlCommand::kReset));
    run.Step(15);
    EXPECT_FALSE(run.Ask(ControlCommand::kRewind, 30).done);
    Rewind(run, 12);
    ExpectSame(run, hashes, 19);
    const Result<RunSummary> summary = run.Finish();
    ASSERT_TRUE(summary.ok()) << summary.error().ToString();
    EXPECT_EQ(summary.value().rejected, 0u);
  }
  ExpectEqualReplay(files.recording());
}

TEST(RewoundRunTest, ARunWithoutRecordingSaysSo) {
  ControlledRun run(Yard(1), {});
  run.Step(3);
  const ControlReply reply = run.Ask(ControlCommand::kRewind, 1);
  EXPECT_FALSE(reply.done);
  EXPECT_THAT(reply.problem, HasSubstr("the run keeps no recording to be rewound by"));
}

}  // namespace
}  // namespace troupe::test
