// A run with a list of observers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "tests/support/files.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "tests/unit/world-service/service/coordinator_fixture.h"
#include "tests/unit/world-service/service/live_run_fixture.h"
#include "transport/protocol/transport.h"
#include "world-service/observers/recorder/recorder.h"
#include "world-service/observers/status/reporter.h"
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
    return start_outcome;
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

  Status start_outcome;
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
  bad.start_outcome = Failure("no paper");
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

using nlohmann::json;

class LauncherReporterTest : public testing::Test {
 protected:
  LauncherReporterTest() {
    EXPECT_EQ(pipe(ends_), 0);
    reading_ = fdopen(ends_[0], "r");
    reporter_ = MakeLauncherReporter(ends_[1]);
  }
  ~LauncherReporterTest() override {
    std::fclose(reading_);
    close(ends_[1]);
  }
  json Next() {
    char line[4096] = "\n";
    // Empty lines end those that another service has begun.
    while (std::string(line) == "\n") {
      line[0] = '\0';
      EXPECT_NE(std::fgets(line, sizeof line, reading_), nullptr);
    }
    return json::parse(line);
  }

  int ends_[2] = {-1, -1};
  std::FILE* reading_ = nullptr;
  std::unique_ptr<Reporter> reporter_;
};

TEST_F(LauncherReporterTest, ReportsTheRobotsThatNeedAgents) {
  RunSettings settings{.robots_per_process = 3, .restart_agents = 5};
  SmallWorld world;
  world.AddRobot("r0", {});
  world.AddRobot("r1", {0.0, 2.0, 0.0, 0.0});
  world.AddRobot("gone", {0.0, 4.0, 0.0, 0.0});
  WorldDescription described = world.world();
  described.models[described.robots[2].root.index()].removed = true;
  described.robots[1].name = "bad \xff bytes";
  reporter_->Ready(described, settings, {{{7410, "0102030405060708090a0b0c"}, {7430, "0102030405060708090a0b0d"}}});
  const json report = Next();
  EXPECT_EQ(report["type"], "ready");
  EXPECT_EQ(report["robots"].size(), 2u);
  EXPECT_EQ(report["robots"][0], "r0");
  EXPECT_EQ(report["robots_per_process"], 3);
  EXPECT_EQ(report["restart_agents"], 5);
  EXPECT_EQ(report["aborts_on_loss"], false);
  ASSERT_EQ(report["participants"].size(), 2u);
  EXPECT_EQ(report["participants"][0]["port"], 7410);
  EXPECT_EQ(report["participants"][1]["participant"], "0102030405060708090a0b0d");
}

TEST_F(LauncherReporterTest, ReportsTheNewRobotsOfAnEdit) {
  reporter_->OnNewRobots({"late", "later"}, 3);
  const json report = Next();
  EXPECT_EQ(report["type"], "robots");
  EXPECT_EQ(report["robots"], (std::vector<std::string>{"late", "later"}));
  EXPECT_EQ(report["edition"], 3);
}

TEST_F(LauncherReporterTest, ReportsTheProgressAndTheEndOfTheRun) {
  reporter_->OnStarted(0.5);
  EXPECT_EQ(Next()["type"], "started");
  reporter_->OnStatus(StatusMessage{.tick = 7, .waiting_for = {"r1"}});
  const json reported = Next();
  EXPECT_EQ(reported["type"], "status");
  EXPECT_EQ(reported["tick"], 7);
  EXPECT_EQ(reported["waiting_for"], json({"r1"}));
  reporter_->OnEvent({7, EventType::kLeft, RobotId(0), std::nullopt, ""}, "a text");
  EXPECT_EQ(Next(), json::parse(R"({"type":"event","tick":7,"event":"left","text":"a text"})"));
  reporter_->OnNotice("a notice");
  EXPECT_EQ(Next()["text"], "a notice");
  reporter_->Ended(RunSummary{.ticks = 9, .state_hash = 0xabc, .slowest = {{"r1", 3, 0.25}}});
  const json end = Next();
  EXPECT_EQ(end["type"], "end");
  EXPECT_EQ(end["ticks"], 9);
  EXPECT_EQ(end["state_hash"], "0000000000000abc");
  EXPECT_EQ(end["slowest"][0]["times_last"], 3);
}

TEST_F(LauncherReporterTest, ReportsTheErrorOfARunThatFailed) {
  testing::internal::CaptureStderr();
  reporter_->Failed({{"file"}, "why"});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "file: error: why\n");
  EXPECT_EQ(Next(), json::parse(R"({"type":"error","message":"file: error: why"})"));
}

}  // namespace
}  // namespace troupe
