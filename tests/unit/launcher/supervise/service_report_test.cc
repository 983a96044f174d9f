#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/base/json.h"
#include "launcher/supervise/output_files.h"
#include "launcher/supervise/reports.h"
#include "tests/support/files.h"

namespace troupe {
namespace {

template <typename T>
T Parse(const std::string& line) {
  std::optional<ServiceReport> report = ParseServiceReport(line);
  EXPECT_TRUE(report && std::holds_alternative<T>(*report)) << line;
  return report && std::holds_alternative<T>(*report) ? std::get<T>(*report) : T{};
}

TEST(ServiceReport, ReadyNamesTheRobotsAndThePort) {
  auto ready = Parse<ReadyReport>(
      R"({"type":"ready","robots":["r0","r1"],"libraries":["a.so"],"robots_per_process":2,"restart_agents":5,)"
      R"("aborts_on_loss":true,"participants":[{"port":17910,"participant":"0102030405060708090a0b0c"},{"port":17930}]})");
  EXPECT_EQ(ready.robots, (std::vector<std::string>{"r0", "r1"}));
  EXPECT_EQ(ready.libraries, (std::vector<std::string>{"a.so"}));
  EXPECT_EQ(ready.robots_per_process, 2u);
  EXPECT_EQ(ready.restart_agents, 5u);
  EXPECT_TRUE(ready.aborts_on_loss);
  EXPECT_EQ(ready.participants, (std::vector<ServiceParticipant>{{17910, "0102030405060708090a0b0c"}, {17930, ""}}));
}

TEST(ServiceReport, RobotsNamesTheRobotsOfAnEdit) {
  EXPECT_EQ(Parse<NewRobotsReport>(R"({"type":"robots","robots":["late"]})").robots,
            (std::vector<std::string>{"late"}));
}

TEST(ServiceReport, StatusNamesTheAwaitedRobots) {
  auto status = Parse<StatusMessage>(
      R"({"type":"status","tick":7,"target_ticks":10,"sim_seconds":0.7,"real_time_factor":2.5,"robots":2,)"
      R"("waiting_for":["r1"],"waiting_seconds":0.3})");
  EXPECT_EQ(status.tick, 7u);
  EXPECT_EQ(status.target_ticks, 10u);
  EXPECT_EQ(status.waiting_for, (std::vector<std::string>{"r1"}));
  EXPECT_EQ(status.waiting_seconds, 0.3);
  EXPECT_EQ(status.speed, std::nullopt);
}

TEST(ServiceReport, AStatusHasAllItsFields) {
  StatusMessage status{.run = 0xfedcba9876543211u,
                       .tick = 7,
                       .target_ticks = 10,
                       .sim_seconds = 0.7,
                       .wall_seconds = 0.5,
                       .real_time_factor = 1.4,
                       .robots = 3,
                       .agents = 2,
                       .waiting_for = {"r1", "r2"},
                       .waiting_seconds = 0.3,
                       .edition = 4,
                       .incarnation = 5,
                       .speed = 2.0,
                       .phases = {0.1, 0.2, 0.3, 0.4}};
  nlohmann::json report = FieldsToJson<nlohmann::json>(status);
  report["type"] = "status";
  EXPECT_EQ(Parse<StatusMessage>(report.dump()), status);
}

TEST(ServiceReport, EndContainsTheSummaryWithAllBitsOfTheHash) {
  auto summary = Parse<RunSummary>(
      R"({"type":"end","ticks":600,"stalls":3,"state_hash":"fedcba9876543211","lost":["r1"],"interrupted":true,)"
      R"("slowest":[{"robot":"r0","times_last":5,"waited_seconds":0.25}]})");
  EXPECT_EQ(summary.ticks, 600u);
  EXPECT_EQ(summary.state_hash, 0xfedcba9876543211u);
  EXPECT_EQ(summary.lost, (std::vector<std::string>{"r1"}));
  EXPECT_TRUE(summary.interrupted);
  ASSERT_EQ(summary.slowest.size(), 1u);
  EXPECT_EQ(summary.slowest[0].times_last, 5u);
}

TEST(ServiceReport, EventsAndNoticesAreLines) {
  auto event = Parse<EventReport>(R"({"type":"event","tick":3,"event":"left","text":"tick 3: r0 left"})");
  EXPECT_EQ(event.event, "left");
  EXPECT_EQ(event.text, "tick 3: r0 left");
  EXPECT_EQ(Parse<EventReport>(R"({"type":"notice","text":"beware"})").text, "beware");
}

TEST(ServiceReport, OtherLinesAreIgnored) {
  for (const char* line :
       {"", "nonsense", "[]", "7", R"({"type":"later"})", R"({"type":3})", R"({"type":"status","tick":"seven"})",
        R"({"type":"status","tick":5e72})", R"({"type":"status","tick":-1})",
        R"({"type":"ready","participants":[{"port":70000}]})", R"({"type":"error","message":"m"})"}) {
    EXPECT_FALSE(ParseServiceReport(line)) << line;
  }
}

std::string TextOf(const std::string& line) {
  const std::optional<Error> failure = OutputFailure(line, "/proc/7/fd/15", "scans.json");
  return failure ? failure->ToString() : "";
}

TEST(OutputFailure, NamesTheFileOfTheUser) {
  EXPECT_EQ(TextOf("agent of r0 and 3 more: /proc/7/fd/15: error: cannot write scans: No space left on device"),
            "scans.json: error: cannot write scans: No space left on device");
  EXPECT_EQ(TextOf("/proc/7/fd/15: error: cannot write a trace: File too large"),
            "scans.json: error: cannot write a trace: File too large");
}

TEST(OutputFailure, IsNothingForOtherLines) {
  EXPECT_EQ(TextOf("agent of r0: error: the world service is gone"), "");
  EXPECT_EQ(TextOf("agent of r0: /proc/7/fd/151: error: cannot write scans: No space left on device"), "");
  EXPECT_EQ(TextOf("agent of r0: /x/proc/7/fd/15: error: cannot write scans: No space left on device"), "");
  EXPECT_EQ(TextOf("agent of r0: /proc/7/fd/15: warning: slow"), "");
  EXPECT_FALSE(OutputFailure(": error: x", "", "scans.json"));
}

class MergeScansTest : public testing::Test, public test::TemporaryFolder {};

std::string Line(int tick, const std::string& robot) {
  return "{\"tick\":" + std::to_string(tick) + ",\"robot\":\"" + robot + "\",\"sensor\":\"s\",\"ranges\":[]}\n";
}

TEST_F(MergeScansTest, OrdersByTickAndThenByPart) {
  std::string a = Write("a", Line(0, "a") + Line(0, "a2") + Line(2, "a") + Line(10, "a"));
  std::string b = Write("b", Line(0, "b") + Line(1, "b") + Line(2, "b") + Line(9, "b"));
  ASSERT_TRUE(MergeScans({a, b}, Path("out"), LineFile::Space::kKeep).ok());
  EXPECT_EQ(Read("out"), Line(0, "a") + Line(0, "a2") + Line(0, "b") + Line(1, "b") + Line(2, "a") + Line(2, "b") +
                             Line(9, "b") + Line(10, "a"));
}

TEST_F(MergeScansTest, SeparatesTheScansBeforeAndAfterAReset) {
  const std::string reset = "{\"edition\":3}\n";
  std::string a = Write("a", Line(0, "a") + Line(5, "a") + reset + Line(0, "a") + Line(1, "a"));
  std::string b = Write("b", Line(0, "b") + Line(6, "b") + reset + Line(0, "b"));
  std::string late = Write("late", reset + Line(1, "late"));
  ASSERT_TRUE(MergeScans({a, b, late}, Path("out"), LineFile::Space::kKeep).ok());
  EXPECT_EQ(Read("out"), Line(0, "a") + Line(0, "b") + Line(5, "a") + Line(6, "b") + reset + Line(0, "a") +
                             Line(0, "b") + Line(1, "a") + Line(1, "late"));
}

TEST_F(MergeScansTest, OmitsAnUnfinishedLine) {
  std::string a = Write("a", Line(0, "a") + "{\"tick\":1,\"rob");
  ASSERT_TRUE(MergeScans({a}, Path("out"), LineFile::Space::kKeep).ok());
  EXPECT_EQ(Read("out"), Line(0, "a"));
}

TEST_F(MergeScansTest, OmitsTheRepeatedScansOfARestartedRobot) {
  std::string once = Line(4, "a") + Line(5, "a") + Line(5, "b") + Line(5, "c") + Line(6, "a");
  std::string a = Write(
      "a", Line(4, "a") + Line(5, "a") + Line(5, "b") + Line(5, "a") + Line(5, "b") + Line(5, "c") + Line(6, "a"));
  ASSERT_TRUE(MergeScans({a}, Path("out"), LineFile::Space::kKeep).ok());
  EXPECT_EQ(Read("out"), once);
}

TEST_F(MergeScansTest, TreatsAMissingPartAsEmpty) {
  std::string a = Write("a", Line(0, "a"));
  ASSERT_TRUE(MergeScans({Path("none"), a}, Path("out"), LineFile::Space::kKeep).ok());
  EXPECT_EQ(Read("out"), Line(0, "a"));
}

TEST_F(MergeScansTest, ReportsAPartThatCannotBeRead) {
  std::string a = Write("a", Line(0, "a"));
  Status failure = MergeScans({a, "/"}, Path("out"), LineFile::Space::kKeep);
  ASSERT_FALSE(failure.ok());
  EXPECT_EQ(failure.error().ToString(), "/: error: cannot read: Is a directory");
}

TEST_F(MergeScansTest, ReportsAFullDisk) {
  std::string a = Write("a", Line(0, "a"));
  Status failure = MergeScans({a}, "/dev/full", LineFile::Space::kKeep);
  ASSERT_FALSE(failure.ok());
  EXPECT_THAT(failure.error().ToString(), testing::HasSubstr("/dev/full"));
}

}  // namespace
}  // namespace troupe
