#include "world-service/observers/recorder/run_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <latch>
#include <thread>

#include "recording/journal.h"
#include "recording/recording.h"
#include "tests/unit/world-service/service/coordinator_fixture.h"
#include "tests/unit/world-service/service/live_run_fixture.h"
#include "transport/protocol/transport.h"
#include "world-service/service/run_service.h"

namespace troupe {
namespace {

// A disk: slow, or full after some bytes.
class Disk final : public mcap::ByteSink {
 public:
  struct Options {
    std::size_t room = std::size_t{1} << 30;
    std::chrono::milliseconds write_time{0};
  };
  Disk(std::vector<std::byte>& bytes, const Options& options) : bytes_(bytes), options_(options) {}

  Status Write(std::span<const std::byte> bytes) override {
    if (bytes_.size() + bytes.size() > options_.room) return Error{{"disk"}, "no space", ErrorCode::kOutputFailed};
    std::this_thread::sleep_for(options_.write_time);  // that is what is slow about it
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return {};
  }
  Status Close() override { return {}; }

 private:
  std::vector<std::byte>& bytes_;
  const Options options_;
};

class RunRecorderTest : public testing::Test, protected RunObserver {
 protected:
  RunRecorderTest() { options_.settings.ticks = 40; }

  Result<RunSummary> Run(const Disk::Options& disk = {}) {
    RunRecorder recorder(std::make_unique<Disk>(bytes_, disk), recording_options_);
    const std::unique_ptr<Transport> transport = MakeMemoryTransport();
    test::SteadyAgent first(*transport, 0);
    test::SteadyAgent second(*transport, 1);
    return RunService(scene_, options_, transport->MakeServiceEndpoint(), {&recorder, this}, stop_);
  }
  Result<Recording> Open() const { return Recording::Open(mcap::MakeMemorySource("run.mcap", bytes_)); }

  Status OnTick(const CommittedTick& tick) override {
    frames_.push_back(tick.frame);
    proposals_.emplace_back(tick.proposals.begin(), tick.proposals.end());
    return {};
  }

  const std::shared_ptr<const Scene> scene_ = std::make_shared<const Scene>(test::PlaneWorld(2));
  ServiceOptions options_;
  RecordingOptions recording_options_ = {.world_file = "plane.world", .keyframe_interval = 7};
  std::atomic<bool> stop_ = false;
  std::vector<std::byte> bytes_;
  std::vector<FrameMessage> frames_;
  std::vector<std::vector<Proposal>> proposals_;
};

TEST_F(RunRecorderTest, RecordsEachTickWithItsProposalsEventsAndHash) {
  ASSERT_TRUE(Run().ok());
  const Result<Recording> recording = Open();
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_FALSE(recording.value().damage());
  EXPECT_TRUE(recording.value().CheckData().ok());
  EXPECT_EQ(recording.value().run().world, scene_->world());
  EXPECT_EQ(recording.value().run().file, "plane.world");
  EXPECT_EQ(recording.value().run().keyframe_interval, 7u);
  EXPECT_EQ(recording.value().run().settings.ticks, 40u);
  EXPECT_EQ(recording.value().run().run, frames_.front().run);
  EXPECT_EQ(recording.value().keyframes(), 7u) << "0, 7, ..., 35 and the last";
  TickReader reader(recording.value());
  RecordedTick tick;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    ASSERT_TRUE(reader.Next(tick).value()) << i;
    EXPECT_EQ(tick.number, i);
    EXPECT_EQ(tick.tick, frames_[i].state.tick);
    EXPECT_EQ(tick.state_hash, frames_[i].state_hash);
    EXPECT_EQ(tick.proposals, proposals_[i]);
    EXPECT_EQ(tick.events.size(), frames_[i].events.size());
    EXPECT_FALSE(tick.edit);
    EXPECT_EQ(tick.keyframe.has_value(), i % 7 == 0 || i == 40);
    if (tick.keyframe) {
      EXPECT_EQ(tick.keyframe->state, frames_[i].state);
    }
  }
  EXPECT_FALSE(reader.Next(tick).value());
}

TEST_F(RunRecorderTest, LetsTheRunWaitForASlowDiskAndLosesNoTick) {
  recording_options_.keyframe_interval = 1;  // each tick is written by itself
  recording_options_.queue_bytes = 1;
  const Result<RunSummary> summary = Run({.write_time = std::chrono::milliseconds(3)});
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_GT(summary.value().record_waited_seconds, 0.0);
  const Result<Recording> recording = Open();
  ASSERT_TRUE(recording.ok());
  EXPECT_EQ(recording.value().spans().greatest(), 40u);
  EXPECT_EQ(recording.value().keyframes(), 41u);
}

TEST_F(RunRecorderTest, DoesNotWaitForAFastDisk) {
  const Result<RunSummary> summary = Run();
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(summary.value().record_waited_seconds, 0.0);
}

TEST_F(RunRecorderTest, AFullDiskEndsTheRun) {
  options_.settings.ticks.reset();
  recording_options_.keyframe_interval = 1;
  const Result<RunSummary> summary = Run({.room = 100'000});
  ASSERT_FALSE(summary.ok());
  EXPECT_EQ(summary.error().message, "no space");
  EXPECT_EQ(summary.error().code, ErrorCode::kOutputFailed);
  const Result<Recording> recording = Open();
  ASSERT_TRUE(recording.ok()) << "the part that is written is readable";
  EXPECT_TRUE(recording.value().damage());
}

class NoControl final : public WorldControl {
  void Request(const control::Request&, ControlReplyTo) override {}
};

// A pause reports progress on the thread that delivers it, while the thread of the run writes a rewind.
TEST_F(RunRecorderTest, ProgressThatIsReportedWithinARewindTearsNoRecordOfTheJournal) {
  constexpr std::uint64_t kStates = 2000;  // less than a file of the tail
  std::string pattern = testing::TempDir() + "troupe-recorder-XXXXXX";
  const std::filesystem::path folder = mkdtemp(pattern.data());
  recording_options_.journal = JournalFiles::Of((folder / "run.mcap").string());
  const JournalFiles& files = *recording_options_.journal;
  {
    const std::unique_ptr<RunRecorder> recorder = RunRecorder::Create(files.recording, recording_options_).value();
    NoControl control;
    ASSERT_TRUE(recorder->OnBegin({7, options_.settings, scene_, control}).ok());
    std::latch both(2);
    std::jthread pauses([&] {
      both.arrive_and_wait();
      for (std::uint64_t i = 0; i < kStates; ++i) EXPECT_TRUE(recorder->OnProgress({}).ok());
    });
    both.arrive_and_wait();
    std::uint64_t made = 0;
    const Status written = recorder->AppendRewind([&](RecordedTick& tick) -> Result<bool> {
      if (made == kStates) return false;
      tick.tick = made++;
      return true;
    });
    EXPECT_TRUE(written.ok());
    pauses.join();
    const JournalTailContent tail = ReadJournalTail(files, 7, 0).value();
    EXPECT_EQ(tail.ticks.size(), kStates);
    EXPECT_EQ(tail.next_serial, 2 * kStates);
    EXPECT_TRUE(tail.progress->is_rewinding) << "until its end is committed";
    EXPECT_TRUE(recorder->OnEnd().ok());
  }
  std::filesystem::remove_all(folder);
}

TEST_F(RunRecorderTest, ADiskThatIsFullFromTheStartEndsTheRunBeforeItBegins) {
  const Result<RunSummary> summary = Run({.room = 100});
  ASSERT_FALSE(summary.ok());
  EXPECT_EQ(summary.error().message, "no space");
  EXPECT_TRUE(frames_.empty());
}

}  // namespace
}  // namespace troupe
