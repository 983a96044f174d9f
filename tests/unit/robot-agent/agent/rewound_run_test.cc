// Runs that are set back to an earlier tick: they continue as before, with the memory of their controllers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <functional>
#include <optional>
#include <utility>

#include "tests/support/controlled_run.h"
#include "tests/support/edits.h"
#include "tests/support/files.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "world-service/replay/continued_run.h"
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
  Files() { folder_.Write("robots.world", "define scout position ( size [0.3 0.3 0.2] ctrl \"wander\" )\n"); }
  std::string definitions() const { return folder_.Path("robots.world"); }
  std::string recording() const { return folder_.Path("run.mcap"); }

 private:
  const TemporaryFolder folder_;
};

OutputFiles Record(const std::string& path, std::uint64_t keyframe_interval) {
  return {.record = path, .keyframe_interval = keyframe_interval};
}

void Rewind(ControlledRun& run, Tick tick) {
  const ControlReply reply = run.Ask(control::Rewind{.tick = tick});
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
  const Recording recording = ValueOf(Recording::Open(path));
  ReplayOptions options;
  options.compare_events = true;
  const ReplayReport report = ValueOf(RunReplay(recording, options).Run());
  EXPECT_EQ(report.difference, std::nullopt);
  EXPECT_EQ(report.damage, std::nullopt);
  EXPECT_GT(report.states, 100u);
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
    const ControlReply future = run.Ask(control::Rewind{.tick = 36});
    EXPECT_FALSE(future.done);
    EXPECT_THAT(future.problem, HasSubstr("found tick 36, expected at most 35"));
    EXPECT_EQ(ValueOf(run.Finish()).rejected, 0u);
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
  EXPECT_TRUE(run.Ask(control::Play()).done);
  const ControlReply reply = run.Ask(control::Rewind{.tick = 50});
  ASSERT_TRUE(reply.done) << reply.problem;
  const std::size_t begin = run.frames().size();
  while (run.frames().size() < begin + 20) std::this_thread::yield();
  EXPECT_TRUE(run.Ask(control::Pause()).done);
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
    const auto ask = [&](const control::Request& request) {
      const ControlReply reply = run.Ask(request);
      ASSERT_TRUE(reply.done) << reply.problem;
    };
    control::Spawn spawn{.name = "late", .pose = {-2.0, 2.0, 0.0, 0.5}};
    spawn.source = "scout";
    run.Step(20);
    ask(spawn);  // at tick 20
    run.Step(20);
    ask(control::Delete{.name = "r1"});  // at tick 40
    run.Step(20);
    ask(control::SetPose{.name = "r2", .pose = {0.5, 3.0, 0.0, 1.0}});  // at tick 60
    run.Step(40);
    std::vector<std::uint64_t> hashes;  // of the last state of each tick
    for (const FrameMessage& frame : run.frames()) {
      hashes.resize(frame.state.tick + 1);
      hashes.back() = frame.state_hash;
    }
    Rewind(run, 75);
    ExpectSame(run, hashes, 100);
    Rewind(run, 50);
    EXPECT_EQ(run.Ask(control::Entities()).entities.size(), 4u + 4u);  // walls, and r0, r2, r3, late
    run.Step(10);
    ask(control::SetPose{.name = "r2", .pose = {0.5, 3.0, 0.0, 1.0}});
    ExpectSame(run, hashes, 90);
    Rewind(run, 30);  // r1 has an agent again
    run.Step(10);
    ask(control::Delete{.name = "r1"});
    ExpectSame(run, hashes, 60 - 1);
    Rewind(run, 10);  // nothing is spawned
    run.Step(10);
    ask(spawn);
    ExpectSame(run, hashes, 39);
    // Behind a reset the past begins anew.
    ask(control::Reset());
    run.Step(15);
    EXPECT_FALSE(run.Ask(control::Rewind{.tick = 30}).done);
    Rewind(run, 12);
    ExpectSame(run, hashes, 19);
    EXPECT_EQ(ValueOf(run.Finish()).rejected, 0u);
  }
  ExpectEqualReplay(files.recording());
}

// The history of its agent ends in a world without the robot.
TEST(RewoundRunTest, ARobotThatWasSpawnedAtTheTickKeepsItsAgent) {
  const DefinitionFile definitions;
  ControlledRun run(CountingYard(), {.world_file = definitions.path(), .can_rewind = true});
  control::Spawn spawn{.source = "scout", .name = "late", .pose = {-2.0, 2.0, 0.0, 0.5}};
  run.Step(5);
  EXPECT_TRUE(run.Ask(spawn).done);
  for (int i = 0; i < 2; ++i) {
    Rewind(run, 5);
    EXPECT_EQ(run.Ask(control::Entities()).entities.size(), 4u + 5u);  // walls, and r0 to r3 and late
  }
  run.Step(10);
  const std::vector<std::uint64_t> hashes = run.Hashes();
  Rewind(run, 5);
  run.Step(10);
  EXPECT_EQ(run.Hashes().back(), hashes.back());
}

std::size_t RewindsIn(const std::string& path) {
  const Recording recording = Recording::Open(path).value();
  std::size_t rewinds = 0;
  EXPECT_TRUE(recording
                  .VisitEdits(recording.chunks(),
                              [&](std::uint64_t, const RecordedEdit& edit) {
                                rewinds += control::Is<control::Rewind>(edit.request);
                                return Status();
                              })
                  .ok());
  return rewinds;
}

// The history of a run, whose first rewind makes states as the test says: `call` counts them from 0.
class HistoryWithFaults final : public RunHistory {
 public:
  using Make = std::function<Result<bool>(std::uint64_t call, RewindStates& states)>;
  HistoryWithFaults(RunHistory* history, Make make) : history_(history), make_(std::move(make)) {}
  Result<std::vector<HistoryEntry>> Read(const HistoryRequest& request) override { return history_->Read(request); }
  Result<std::unique_ptr<RewindStates>> StartRewind(const control::Rewind& request,
                                                    const FrameMessage& newest) override {
    Result<std::unique_ptr<RewindStates>> states = history_->StartRewind(request, newest);
    if (!make_ || !states.ok()) return states;
    return std::unique_ptr<RewindStates>(
        std::make_unique<States>(std::move(states).value(), std::exchange(make_, nullptr)));
  }

 private:
  class States final : public RewindStates {
   public:
    States(std::unique_ptr<RewindStates> states, Make make) : states_(std::move(states)), make_(std::move(make)) {}
    Result<bool> MakeSome() override { return make_(calls_++, *states_); }
    Result<RewoundRun> Write() override { return states_->Write(); }

   private:
    const std::unique_ptr<RewindStates> states_;
    const Make make_;
    std::uint64_t calls_ = 0;
  };

  RunHistory* const history_;
  Make make_;
};

TEST(RewoundRunTest, ARewindThatFailsLeavesTheRunAndItsRecordingAsTheyAre) {
  const Files files;
  std::optional<HistoryWithFaults> history;
  {
    const auto fail = [](std::uint64_t call, RewindStates& states) -> Result<bool> {
      return call == 50 ? Failure("a state cannot be read") : states.MakeSome();
    };
    ControlledRun run(CountingYard(), {.outputs = Record(files.recording(), 10),
                                       .wrap_history = [&](RunHistory* real, std::atomic<bool>&) {
                                         return &history.emplace(real, fail);
                                       }});
    run.Step(100);
    const std::vector<std::uint64_t> hashes = run.Hashes();
    const ControlReply failed = run.Ask(control::Rewind{.tick = 95});
    EXPECT_FALSE(failed.done);
    EXPECT_EQ(failed.problem, "a state cannot be read");
    run.Step(20);
    Rewind(run, 95);
    ExpectSame(run, hashes, 100);
    ASSERT_TRUE(run.Finish().ok());
  }
  EXPECT_EQ(RewindsIn(files.recording()), 1u);
  ExpectEqualReplay(files.recording());
}

TEST(RewoundRunTest, AStopEndsARewind) {
  const Files files;
  std::optional<HistoryWithFaults> history;
  {
    const auto wrap = [&](RunHistory* real, std::atomic<bool>& stop) {
      return &history.emplace(real, [&stop](std::uint64_t, RewindStates&) -> Result<bool> {
        stop = true;
        return true;  // there is always another state to be made
      });
    };
    ControlledRun run(CountingYard(), {.outputs = Record(files.recording(), 10), .wrap_history = wrap});
    run.Step(120);
    const ControlReply reply = run.Ask(control::Rewind{.tick = 50});
    EXPECT_FALSE(reply.done);
    EXPECT_EQ(reply.problem, "the run is over");
    EXPECT_EQ(reply.tick, 120u);
    EXPECT_TRUE(ValueOf(run.Finish()).interrupted);
  }
  EXPECT_EQ(RewindsIn(files.recording()), 0u);
  ExpectEqualReplay(files.recording());
}

TEST(RewoundRunTest, AJournalBesideTheRecordingHasTheRewindToo) {
  const Files files;
  const std::string journal = files.recording() + ".journal.mcap";
  OutputFiles outputs = Record(files.recording(), 10);
  outputs.journal = JournalFiles::Of(journal);
  {
    ControlledRun run(CountingYard(), {.outputs = outputs});
    run.Step(80);
    Rewind(run, 30);
    run.Step(10);
    ASSERT_TRUE(run.Finish().ok());
  }
  for (const std::string& path : {files.recording(), journal}) {
    SCOPED_TRACE(path);
    EXPECT_EQ(RewindsIn(path), 1u);
    ExpectEqualReplay(path);
  }
}

class NoControl final : public WorldControl {
  void Request(const control::Request&, ControlReplyTo) override {}
};

// The ticks of the branch are not read as states of the rewind.
TEST(RewoundRunTest, ABranchFromWithinARewindHasNoMoreOfItsStates) {
  const Files files;
  {
    ControlledRun run(CountingYard(), {.outputs = Record(files.recording(), 10)});
    run.Step(60);
    Rewind(run, 50);
    ASSERT_TRUE(run.Finish().ok());
  }
  BranchOptions options;
  options.from = 20;
  const BranchedRun branch = ValueOf(BranchRun(files.recording(), options));
  ASSERT_EQ(branch.begin->last_number, 81u) << "0 to 60, and 0 to 20 again";
  const std::string path = files.recording() + ".branch.mcap";
  const auto recorder = RunRecorder::Create(path, {.world_file = {}, .begin = branch.begin}).value();
  NoControl control;
  ASSERT_TRUE(recorder->OnBegin({1, {}, branch.resumed.scene, control}).ok());
  ASSERT_TRUE(recorder->OnEnd().ok());
  const Recording recording = Recording::Open(path).value();
  std::vector<std::uint64_t> copies;
  const Status visited = recording.VisitEdits(recording.chunks(), [&](std::uint64_t, const RecordedEdit& edit) {
    copies.push_back(edit.copies);
    return Status();
  });
  ASSERT_TRUE(visited.ok());
  EXPECT_THAT(copies, testing::ElementsAre(20u));
}

// As a service that continues the run itself there.
TEST(RewoundRunTest, ABranchCanRestoreWhatWasDeletedBeforeIt) {
  const Files files;
  const WorldDescription world = Yard(3);
  const std::string first = world.robots[0].name;
  const std::string second = world.robots[1].name;
  {
    ControlledRun run(world, {.outputs = Record(files.recording(), 10)});
    run.Step(10);
    ASSERT_TRUE(run.Ask(control::Delete{.name = first}).done);
    run.Step(10);
    ASSERT_TRUE(run.Ask(control::Delete{.name = second}).done);
    run.Step(10);
    ASSERT_TRUE(run.Finish().ok());
  }
  const auto deleted = [&](std::optional<Tick> from) {
    BranchOptions options;
    options.from = from;
    std::vector<std::string> names;
    for (const DeletedEntity& each : ValueOf(BranchRun(files.recording(), options)).resumed.deleted) {
      names.push_back(each.name);
    }
    return names;
  };
  EXPECT_THAT(deleted(5), testing::IsEmpty());
  EXPECT_THAT(deleted(15), testing::ElementsAre(first));
  EXPECT_THAT(deleted(std::nullopt), testing::ElementsAre(first, second));
}

TEST(RewoundRunTest, ARunWithoutRecordingSaysSo) {
  ControlledRun run(Yard(1), {});
  run.Step(3);
  const ControlReply reply = run.Ask(control::Rewind{.tick = 1});
  EXPECT_FALSE(reply.done);
  EXPECT_THAT(reply.problem, HasSubstr("the run keeps no recording to be rewound by"));
}

}  // namespace
}  // namespace troupe::test
