// Runs whose world service dies after any of its states: another one restores the newest state, the files of the user,
// and the memory that agents need. A rewind that was interrupted is finished first.
#include <gtest/gtest.h>

#include "recording/journal.h"
#include "recording/recording.h"
#include "recording/recording_writer.h"
#include "tests/support/controlled_run.h"
#include "tests/support/files.h"
#include "tests/support/small_world.h"
#include "world-service/program/prepared_run.h"
#include "world-service/replay/branched_run.h"

namespace troupe::test {
namespace {

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
      EXPECT_TRUE(tail->Append(&tick, progress).ok());
      EXPECT_TRUE(tick.number >= recorded || writer.Add(tick).ok());
    }
    EXPECT_TRUE(writer.EndChunk().ok());
    return files;
  }

  Result<PreparedRun> Resume(const JournalFiles& files, bool with_hashes = true) const {
    RunSource source;
    source.resume = true;
    source.outputs.journal = files;
    if (with_hashes) source.outputs.hash_log = folder_.Path("resumed-hashes");
    Result<PreparedRun> run = PrepareRun(source);
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

constexpr std::uint64_t kBeforeRewind = 42;          // 0 to 40, and the edit
constexpr std::uint64_t kAfterRewind = 42 + 1 + 36;  // tick 0 again, 35 steps and the edit
constexpr std::uint64_t kEdit = 31;                  // its number

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

}  // namespace
}  // namespace troupe::test
