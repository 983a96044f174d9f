// A run with a list of observers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>

#include "tests/support/files.h"
#include "tests/support/values.h"
#include "tests/unit/service/coordinator_fixture.h"
#include "tests/unit/service/steady_agent.h"
#include "transport/protocol/transport.h"
#include "world-service/observers/recorder/recorder.h"
#include "world-service/service/run_service.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Remembers the calls that concern the run as a whole, the hashes and the proposals.
class Notebook final : public RunObserver {
 public:
  Status OnBegin(const RunStart& start) override {
    calls.push_back("begin");
    settings = start.settings;
    world = start.scene->world();
    return begin_outcome;
  }
  Status OnEnd() override {
    calls.push_back("end");
    return end_outcome;
  }
  Status OnTick(const CommittedTick& tick) override {
    hashes.push_back(tick.frame.state_hash);
    proposals.emplace_back(tick.proposals.begin(), tick.proposals.end());
    return tick.frame.state.tick == failing_tick ? Status(Failure("the notebook is full")) : Status();
  }

  Status begin_outcome;
  Status end_outcome;
  std::optional<Tick> failing_tick;
  std::vector<std::string> calls;
  RunSettings settings;
  WorldDescription world;
  std::vector<std::uint64_t> hashes;
  std::vector<std::vector<Proposal>> proposals;
};

class SeveralObserversTest : public testing::Test {
 protected:
  SeveralObserversTest() { options_.settings.ticks = 20; }

  Result<RunSummary> Run(const RunObservers& observers) {
    const std::unique_ptr<Transport> transport = MakeMemoryTransport();
    test::SteadyAgent first(*transport, 0);
    test::SteadyAgent second(*transport, 1);
    return RunService(scene_, options_, transport->MakeServiceEndpoint(), observers, stop_);
  }
  std::string MakePath() { return folder_.Path(std::to_string(++paths_)); }

  const std::shared_ptr<const Scene> scene_ = std::make_shared<const Scene>(test::PlaneWorld(2));
  ServiceOptions options_;
  std::atomic<bool> stop_ = false;
  const test::TemporaryFolder folder_;
  int paths_ = 0;
};

TEST_F(SeveralObserversTest, ObservationChangesNoHash) {
  const RunSummary alone = test::ValueOf(Run({}));
  Notebook one;
  Notebook other;
  const auto recorder =
      test::ValueOf(Recorder::Create(scene_->world(), {.hash_log = MakePath(), .poses = MakePath(), .record = ""}));
  EXPECT_EQ(test::ValueOf(Run({&one, recorder.get(), &other})).state_hash, alone.state_hash);
  ASSERT_EQ(one.hashes.size(), 21u);
  EXPECT_EQ(one.hashes.back(), alone.state_hash);
  EXPECT_EQ(one.hashes, other.hashes);
}

TEST_F(SeveralObserversTest, TwoOfAKindWriteTheSame) {
  const OutputFiles files[] = {{.hash_log = MakePath(), .poses = MakePath(), .record = MakePath()},
                               {.hash_log = MakePath(), .poses = MakePath(), .record = MakePath()}};
  const auto one = Recorder::Create(scene_->world(), files[0]);
  const auto other = Recorder::Create(scene_->world(), files[1]);
  ASSERT_TRUE(one.ok() && other.ok());
  ASSERT_TRUE(Run({one.value().get(), other.value().get()}).ok());
  EXPECT_THAT(test::TextOf(files[0].hash_log), HasSubstr("\n20 "));
  EXPECT_EQ(test::TextOf(files[0].hash_log), test::TextOf(files[1].hash_log));
  EXPECT_EQ(test::TextOf(files[0].poses), test::TextOf(files[1].poses));
  EXPECT_EQ(test::TextOf(files[0].record), test::TextOf(files[1].record));
}

TEST_F(SeveralObserversTest, ReportTheInputsOfEachTick) {
  options_.settings.on_agent_loss = OnAgentLoss::kPause;
  Notebook notebook;
  ASSERT_TRUE(Run({&notebook}).ok());
  EXPECT_EQ(notebook.settings.ticks, 20u);
  EXPECT_EQ(notebook.settings.on_agent_loss, OnAgentLoss::kPause);
  EXPECT_EQ(notebook.world, scene_->world());
  ASSERT_EQ(notebook.proposals.size(), 21u);
  EXPECT_TRUE(notebook.proposals[0].empty());
  for (std::size_t tick = 1; tick <= 20; ++tick) {
    ASSERT_EQ(notebook.proposals[tick].size(), 2u);
    EXPECT_EQ(notebook.proposals[tick][1].robot, RobotId(1));
    EXPECT_EQ(notebook.proposals[tick][1].twist.vx, 1.0);
  }
}

TEST_F(SeveralObserversTest, OneThatFailsEndsTheRunAndTheOthersAreCompleted) {
  Notebook good;
  Notebook bad;
  bad.failing_tick = 7;
  const Result<RunSummary> summary = Run({&bad, &good});
  ASSERT_FALSE(summary.ok());
  EXPECT_EQ(summary.error().message, "the notebook is full");
  EXPECT_EQ(good.hashes.size(), 8u);  // the tick of the failure, too
  EXPECT_THAT(good.calls, ElementsAre("begin", "end"));
  EXPECT_THAT(bad.calls, ElementsAre("begin", "end"));
}

TEST_F(SeveralObserversTest, OneThatCannotBeginEndsTheRunBeforeItsFirstTick) {
  Notebook good;
  Notebook bad;
  Notebook behind;
  bad.begin_outcome = Failure("no paper");
  const Result<RunSummary> summary = Run({&good, &bad, &behind});
  ASSERT_FALSE(summary.ok());
  EXPECT_EQ(summary.error().message, "no paper");
  EXPECT_THAT(good.calls, ElementsAre("begin", "end"));
  EXPECT_THAT(bad.calls, ElementsAre("begin"));
  EXPECT_TRUE(behind.calls.empty());
  EXPECT_TRUE(good.hashes.empty());
}

TEST_F(SeveralObserversTest, OneThatCannotEndFailsTheRun) {
  Notebook bad;
  bad.end_outcome = Failure("the ink is wet");
  const Result<RunSummary> summary = Run({&bad});
  ASSERT_FALSE(summary.ok());
  EXPECT_EQ(summary.error().message, "the ink is wet");
  EXPECT_EQ(bad.hashes.size(), 21u);
}

TEST_F(SeveralObserversTest, AFullDiskEndsTheRun) {
  const auto recorder =
      test::ValueOf(Recorder::Create(scene_->world(), {.hash_log = "/dev/full", .poses = "", .record = ""}));
  const Result<RunSummary> summary = Run({recorder.get()});
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(summary.error().ToString(), HasSubstr("/dev/full"));
}

}  // namespace
}  // namespace troupe
