#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "tests/support/small_world.h"
#include "world-service/observers/status/reporter.h"

namespace troupe {
namespace {

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
  const json told = Next();
  EXPECT_EQ(told["type"], "status");
  EXPECT_EQ(told["tick"], 7);
  EXPECT_EQ(told["waiting_for"], json({"r1"}));
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
