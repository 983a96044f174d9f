// Recordings that are cut off, or have changed bits or bytes: the replay says so, and compares no state that the run
// did not have.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "recording/recording.h"
#include "tests/support/controlled_run.h"
#include "tests/support/small_world.h"
#include "world-service/replay/run_replay.h"

namespace troupe::test {
namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<std::byte>;

// The recording of a run with steps, edits and a rewind, in many chunks.
Bytes RecordRun() {
  const fs::path file = fs::path(testing::TempDir()) / ("damaged-" + std::to_string(getpid()) + ".mcap");
  {
    OutputFiles outputs{.record = file.string(), .keyframe_interval = 4};
    const WorldDescription world = Yard(2);
    ControlledRun run(world, {.outputs = outputs});
    run.Step(9);
    control::SetPose edit{.name = world.robots[0].name, .pose = {-3.0, -3.0, 0.0, 0.0}};
    EXPECT_TRUE(run.Ask(edit).done);
    run.Step(4);
    EXPECT_TRUE(run.Ask(control::Rewind{.tick = 11}).done);
    run.Step(4);
    EXPECT_TRUE(run.Ask(control::Reset()).done);
    run.Step(3);
    EXPECT_TRUE(run.Finish().ok());
  }
  std::ifstream in(file, std::ios::binary);
  const std::vector<char> text((std::istreambuf_iterator<char>(in)), {});
  fs::remove(file);
  Bytes bytes(text.size());
  std::transform(text.begin(), text.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

struct Outcome {
  bool reported = false;     // an error, a difference or damage
  std::uint64_t states = 0;  // that were compared
  std::uint64_t last_hash = 0;
};

Outcome Replay(const Bytes& bytes) {
  const Result<Recording> recording = Recording::Open(mcap::MakeMemorySource("damaged.mcap", bytes));
  if (!recording.ok()) return {.reported = true};
  ReplayOptions options;
  options.compare_events = true;
  const Result<ReplayReport> report = RunReplay(recording.value(), options).Run();
  if (!report.ok()) return {.reported = true};
  const bool damaged = report.value().difference || report.value().damage || !recording.value().CheckData().ok();
  return {damaged, report.value().states, report.value().state_hash};
}

class DamagedRecordingsTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    whole_ = RecordRun();
    const Recording recording = Recording::Open(mcap::MakeMemorySource("whole.mcap", whole_)).value();
    ASSERT_GT(recording.chunks(), 5u);
    TickReader reader(recording);
    RecordedTick tick;
    while (reader.Next(tick).value()) hashes_.push_back(tick.state_hash);
  }

  // A replay of a prefix has the states of the run.
  static void ExpectReported(const Bytes& damaged, const std::string& damage) {
    const Outcome outcome = Replay(damaged);
    ASSERT_TRUE(outcome.reported) << damage;
    ASSERT_LE(outcome.states, hashes_.size()) << damage;
    if (outcome.states > 0) {
      ASSERT_EQ(outcome.last_hash, hashes_[outcome.states - 1]) << damage;
    }
  }

  static Bytes whole_;
  static std::vector<std::uint64_t> hashes_;  // by the number of the state
};

Bytes DamagedRecordingsTest::whole_;
std::vector<std::uint64_t> DamagedRecordingsTest::hashes_;

TEST_F(DamagedRecordingsTest, TheWholeOneIsReplayed) {
  const Outcome outcome = Replay(whole_);
  EXPECT_FALSE(outcome.reported);
  EXPECT_EQ(outcome.states, hashes_.size());
}

TEST_F(DamagedRecordingsTest, TwoThousandThatAreCutOff) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    const std::size_t size = random() % whole_.size();
    ExpectReported(Bytes(whole_.begin(), whole_.begin() + static_cast<std::ptrdiff_t>(size)),
                   "cut off after " + std::to_string(size) + " bytes");
    if (HasFatalFailure()) return;
  }
}

TEST_F(DamagedRecordingsTest, TwoThousandWithChangedBits) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 2000; ++i) {
    Bytes damaged = whole_;
    std::string damage = "changed bits";
    for (std::size_t left = 1 + random() % 3; left > 0; --left) {
      const std::size_t at = random() % damaged.size();
      const std::size_t bit = random() % 8;
      damaged[at] ^= std::byte(1U << bit);
      damage += " " + std::to_string(bit) + " of byte " + std::to_string(at);
    }
    if (damaged == whole_) continue;
    ExpectReported(damaged, damage);
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace troupe::test
