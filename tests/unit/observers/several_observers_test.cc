// A run with a list of observers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include "tests/unit/service/coordinator_fixture.h"
#include "tests/unit/service/steady_agent.h"
#include "transport/protocol/memory_transport.h"
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
  ~SeveralObserversTest() override {
    for (const std::string& path : paths_) std::remove(path.c_str());
  }

  Result<RunSummary> Run(const RunObservers& observers) {
    const std::unique_ptr<Transport> transport = MakeMemoryTransport();
    test::SteadyAgent first(*transport, 0);
    test::SteadyAgent second(*transport, 1);
    return RunService(scene_, options_, transport->MakeServiceEndpoint(), observers, stop_);
  }
  std::string MakePath() {
    paths_.push_back(testing::TempDir() + "troupe-observers-" + std::to_string(getpid()) + "-" +
                     std::to_string(paths_.size()));
    return paths_.back();
  }
  static std::string Text(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }

  const std::shared_ptr<const Scene> scene_ = std::make_shared<const Scene>(test::PlaneWorld(2));
  ServiceOptions options_;
  std::atomic<bool> stop_ = false;
  std::vector<std::string> paths_;
};

TEST_F(SeveralObserversTest, ObservationChangesNoHash) {
  const Result<RunSummary> alone = Run({});
  ASSERT_TRUE(alone.ok());
  Notebook one;
  Notebook other;
  const auto recorder = Recorder::Create(scene_->world(), {.hash_log = MakePath(), .poses = MakePath(), .record = ""});
  ASSERT_TRUE(recorder.ok());
  const Result<RunSummary> observed = Run({&one, recorder.value().get(), &other});
  ASSERT_TRUE(observed.ok());
  EXPECT_EQ(observed.value().state_hash, alone.value().state_hash);
  ASSERT_EQ(one.hashes.size(), 21u);
  EXPECT_EQ(one.hashes.back(), alone.value().state_hash);
  EXPECT_EQ(one.hashes, other.hashes);
}

TEST_F(SeveralObserversTest, TwoOfAKindWriteTheSame) {
  const OutputFiles files[] = {{.hash_log = MakePath(), .poses = MakePath(), .record = MakePath()},
                               {.hash_log = MakePath(), .poses = MakePath(), .record = MakePath()}};
  const auto one = Recorder::Create(scene_->world(), files[0]);
  const auto other = Recorder::Create(scene_->world(), files[1]);
  ASSERT_TRUE(one.ok() && other.ok());
  ASSERT_TRUE(Run({one.value().get(), other.value().get()}).ok());
  EXPECT_THAT(Text(files[0].hash_log), HasSubstr("\n20 "));
  EXPECT_EQ(Text(files[0].hash_log), Text(files[1].hash_log));
  EXPECT_EQ(Text(files[0].poses), Text(files[1].poses));
  EXPECT_EQ(Text(files[0].record), Text(files[1].record));
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
  const auto recorder = Recorder::Create(scene_->world(), {.hash_log = "/dev/full", .poses = "", .record = ""});
  ASSERT_TRUE(recorder.ok());
  const Result<RunSummary> summary = Run({recorder.value().get()});
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(summary.error().ToString(), HasSubstr("/dev/full"));
}

}  // namespace
}  // namespace troupe
