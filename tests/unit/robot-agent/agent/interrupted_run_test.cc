// Runs whose world service dies after any of its states: another one restores the newest state, the files of the user,
// and the memory that agents need. A rewind that was interrupted is finished first.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <utility>

#include "recording/journal.h"
#include "recording/recording.h"
#include "recording/recording_writer.h"
#include "tests/support/controlled_run.h"
#include "tests/support/files.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "world-service/program/prepared_run.h"
#include "world-service/replay/continued_run.h"

namespace troupe::test {
namespace {

constexpr std::uint64_t kBeforeRewind = 42;          // 0 to 40, and the edit
constexpr std::uint64_t kAfterRewind = 42 + 1 + 36;  // tick 0 again, 35 steps and the edit
constexpr std::uint64_t kEdit = 31;                  // its number

class InterruptedRunTest : public testing::Test {
 protected:
  // 30 steps, a change of a pose, 10 steps, then a rewind to tick 35.
  void RunAndRewind() {
    OutputFiles files{.hash_log = folder_.Path("hashes"), .record = folder_.Path("whole.mcap"), .keyframe_interval = 8};
    const WorldDescription world = Yard(3);
    ControlledRun run(world, {.outputs = files});
    run.Step(30);
    control::SetPose edit{.name = world.robots[0].name, .pose = {-3.0, -3.0, 0.0, 0.0}};
    ASSERT_TRUE(run.Ask(edit).done);
    run.Step(10);
    ASSERT_TRUE(run.Ask(control::Rewind{.tick = 35}).done);
    rewound_ = run.frame();
    ASSERT_TRUE(run.Finish().ok());
  }

  // The journal of a service that died with that many states. Some are in its recording, the others in the tail.
  JournalFiles DieWith(std::uint64_t states, std::uint64_t recorded) const {
    const JournalFiles files = JournalFiles::Of(folder_.Path(std::to_string(states) + ".mcap"));
    const Recording whole = Recording::Open(folder_.Path("whole.mcap")).value();
    RecordingWriter writer =
        RecordingWriter::Create(mcap::CreateFileSink(files.recording).value(), whole.run()).value();
    const std::unique_ptr<JournalTail> tail = JournalTail::Create(files, whole.run().run, JournalSync::kNo).value();
    TickReader reader(whole);
    RecordedTick tick;
    RunProgress progress;
    progress.ticks_to_pause = 0;
    while (reader.Next(tick).value() && tick.number < states) {
      progress.is_rewinding = tick.number >= kBeforeRewind;
      EXPECT_TRUE(tail->Append(&tick, progress).ok());
      EXPECT_TRUE(tick.number >= recorded || writer.Add(tick).ok());
    }
    EXPECT_TRUE(writer.EndChunk().ok());
    return files;
  }

  // The run of the journal, before it writes anything further.
  Result<PreparedRun> Prepare(const JournalFiles& files, bool with_hashes) const {
    RunSource source;
    source.resume = true;
    source.outputs.journal = files;
    if (with_hashes) source.outputs.hash_log = folder_.Path("resumed-hashes");
    return PrepareRun(source);
  }
  Result<PreparedRun> Resume(const JournalFiles& files, bool with_hashes = true) const {
    Result<PreparedRun> run = Prepare(files, with_hashes);
    if (run.ok()) {
      for (const std::unique_ptr<RunObserver>& observer : run.value().recorders.observers) {
        if (!observer->OnEnd().ok()) return Error{{}, "a file cannot be closed"};
      }
    }
    return run;
  }

  const TemporaryFolder folder_;
  FrameMessage rewound_;
};

TEST_F(InterruptedRunTest, ARewindIsFinishedWhereverItWasInterrupted) {
  RunAndRewind();
  const std::string hashes = folder_.Read("hashes");
  for (std::uint64_t states = kBeforeRewind + 1; states <= kAfterRewind; ++states) {
    SCOPED_TRACE(states);
    for (const bool with_hashes : {true, false}) {
      const JournalFiles files = DieWith(states, states - states % 7);
      const Result<PreparedRun> run = Resume(files, with_hashes);
      ASSERT_TRUE(run.ok()) << run.error().ToString();
      const ResumedRun& resumed = *run.value().options.resumed;
      EXPECT_EQ(resumed.frame->state.tick, 35u);
      EXPECT_EQ(resumed.frame->state_hash, rewound_.state_hash);
      EXPECT_EQ(resumed.frame->edition, rewound_.edition);
      EXPECT_EQ(resumed.frame->fresh_edition, rewound_.fresh_edition);
      EXPECT_EQ(resumed.frame->world_edition, rewound_.world_edition);
      EXPECT_EQ(resumed.next_number, kAfterRewind);
      EXPECT_EQ(resumed.previous, (ControllerCheckpoint{rewound_.edition, 34, true}));
      EXPECT_TRUE(!with_hashes || folder_.Read("resumed-hashes") == hashes);
    }
  }
}

TEST_F(InterruptedRunTest, TheStateBeforeTheNewestIsThatOfAnEditOrAStep) {
  RunAndRewind();
  const auto previous = [this](std::uint64_t states, std::uint64_t recorded) {
    return Resume(DieWith(states, recorded)).value().options.resumed->previous;
  };
  EXPECT_EQ(previous(kEdit + 1, kEdit), (ControllerCheckpoint{0, 30, false}));
  EXPECT_EQ(previous(kEdit + 1, kEdit + 1), (ControllerCheckpoint{0, 30, false}));
  EXPECT_EQ(previous(kEdit + 2, kEdit), (ControllerCheckpoint{1, 30, true}));
  EXPECT_EQ(previous(kEdit, kEdit), (ControllerCheckpoint{0, 29, true}));
  EXPECT_EQ(previous(1, 1), std::nullopt);
}

// The history of a run that calls `written` when all states of a rewind are in its journal, and its end is not
// committed.
class HistoryUntilWritten final : public RunHistory {
 public:
  HistoryUntilWritten(RunHistory* history, std::function<void()> written)
      : history_(history), written_(std::move(written)) {}
  Result<std::vector<HistoryEntry>> Read(const HistoryRequest& request) override { return history_->Read(request); }
  Result<std::unique_ptr<RewindStates>> StartRewind(const control::Rewind& request,
                                                    const FrameMessage& newest) override {
    Result<std::unique_ptr<RewindStates>> states = history_->StartRewind(request, newest);
    if (!states.ok()) return states;
    return std::unique_ptr<RewindStates>(std::make_unique<States>(std::move(states).value(), written_));
  }

 private:
  class States final : public RewindStates {
   public:
    States(std::unique_ptr<RewindStates> states, std::function<void()> written)
        : states_(std::move(states)), written_(std::move(written)) {}
    Result<bool> MakeSome() override { return states_->MakeSome(); }
    Result<RewoundRun> Write() override {
      Result<RewoundRun> run = states_->Write();
      written_();
      return run;
    }

   private:
    const std::unique_ptr<RewindStates> states_;
    const std::function<void()> written_;
  };

  RunHistory* const history_;
  const std::function<void()> written_;
};

void Copy(const JournalFiles& from, const JournalFiles& to) {
  const auto copy = [](const std::string& source, const std::string& target) {
    std::filesystem::copy_file(source, target, std::filesystem::copy_options::overwrite_existing);
  };
  copy(from.recording, to.recording);
  for (std::size_t i = 0; i < to.tail.size(); ++i) copy(from.tail[i], to.tail[i]);
}

// The ends of the records in a file of the tail of a journal.
std::vector<std::size_t> RecordEnds(const std::string& bytes) {
  std::vector<std::size_t> ends;
  for (std::size_t end = 0; end < bytes.size();) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + end, sizeof length);
    end += 2 * sizeof length + length;
    ends.push_back(end);
  }
  return ends;
}

// After each write of the journal, with a robot that was deleted since, a command and an input that wait in the pause.
TEST_F(InterruptedRunTest, ADeathAfterAnyWriteOfARewindLeavesTheRunBeforeItOrBehindIt) {
  const JournalFiles live = JournalFiles::Of(folder_.Path("live.mcap"));
  const JournalFiles written = JournalFiles::Of(folder_.Path("written.mcap"));
  const JournalFiles dead = JournalFiles::Of(folder_.Path("dead.mcap"));
  const JournalFiles dead_again = JournalFiles::Of(folder_.Path("dead-again.mcap"));
  std::optional<HistoryUntilWritten> history;
  const WorldDescription world = Yard(3);
  const std::string robot = world.robots[0].name;
  const std::string deleted = world.robots[1].name;
  OutputFiles outputs{.hash_log = folder_.Path("hashes"), .keyframe_interval = 1000};
  outputs.journal = live;
  ControlledRun run(world, {.outputs = outputs, .wrap_history = [&](RunHistory* real, std::atomic<bool>&) {
                              return &history.emplace(real, [&] { Copy(live, written); });
                            }});
  run.Step(20);
  ASSERT_TRUE(run.Ask(control::Delete{.name = deleted}).done);
  run.Step(5);
  const FrameMessage before = run.frame();
  ASSERT_TRUE(run.Ask(control::CommandRobot{.name = robot, .ticks = 1000, .twist = Twist{0.1, 0.0, 0.0}}).done);
  const ControlReply accepted = run.Ask(control::SetTwist{.name = robot, .twist = {0.2, 0.0, 0.0}});
  ASSERT_TRUE(accepted.done) << accepted.problem;
  ASSERT_TRUE(run.Ask(control::Rewind{.tick = 15}).done);
  const FrameMessage rewound = run.frame();
  ASSERT_TRUE(run.Finish().ok());
  const std::string hashes = folder_.Read("hashes");

  const std::string tail = TextOf(written.tail[0]);
  std::size_t deaths_before = 0;
  std::size_t deaths_within = 0;
  for (const std::size_t end : RecordEnds(tail)) {
    Copy(written, dead);
    std::filesystem::resize_file(dead.tail[0], end);
    const RunId id = ValueOf(ReadJournal(dead)).run().run;
    const std::optional<RunProgress> progress = ValueOf(ReadJournalTail(dead, id, 0)).progress;
    ASSERT_TRUE(progress);
    if (!progress->is_rewinding && progress->inputs.empty()) continue;  // long before
    SCOPED_TRACE(end);
    for (const bool with_hashes : {true, false}) {
      Copy(written, dead);
      std::filesystem::resize_file(dead.tail[0], end);
      for (const bool dies_again : {false, true}) {
        const Result<PreparedRun> resumed = Prepare(dies_again ? dead_again : dead, with_hashes);
        ASSERT_TRUE(resumed.ok()) << resumed.error().ToString();
        if (!dies_again) Copy(dead, dead_again);  // before the first service writes more
        const ResumedRun& now = *resumed.value().options.resumed;
        const RunProgress& orders = now.progress;
        EXPECT_FALSE(orders.is_rewinding);
        EXPECT_EQ(orders.ticks_to_pause, 0u);
        if (!progress->is_rewinding) {
          ++deaths_before;
          EXPECT_EQ(now.frame->state_hash, before.state_hash);
          EXPECT_EQ(orders.commands.size(), 1u);
          EXPECT_EQ(orders.inputs.size(), 1u);
          continue;
        }
        deaths_within += dies_again ? 0 : 1;
        EXPECT_EQ(now.frame->state_hash, rewound.state_hash);
        EXPECT_EQ(now.frame->state.tick, 15u);
        EXPECT_EQ(now.frame->edition, rewound.edition);
        EXPECT_EQ(now.previous, (ControllerCheckpoint{rewound.edition, 14, true}));
        EXPECT_TRUE(orders.commands.empty()) << "those that wait are dropped";
        EXPECT_TRUE(orders.inputs.empty());
        const RobotId returned = FindRobot(now.scene->world(), deleted).value();
        EXPECT_THAT(orders.newcomers, testing::ElementsAre(returned)) << "it needs an agent";
        for (const auto& observer : resumed.value().recorders.observers) {
          if (with_hashes && dies_again) {
            EXPECT_TRUE(observer->OnEnd().ok());
          }
        }
        EXPECT_TRUE(!with_hashes || !dies_again || folder_.Read("resumed-hashes") == hashes);
      }
    }
  }
  EXPECT_GT(deaths_before, 0u);
  EXPECT_EQ(deaths_within, 2u * (1u + 15u))
      << "after each state that was written, the last of which is to be committed";
}

}  // namespace
}  // namespace troupe::test
