#include "robot-agent/agent/scan_log.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace troupe {
namespace {

class ScanLogTest : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  std::string Text() const {
    std::stringstream text;
    text << std::ifstream(path_).rdbuf();
    return text.str();
  }

  std::string path_ = ::testing::TempDir() + "/troupe_scan_log_" + std::to_string(getpid());
};

TEST_F(ScanLogTest, WritesALineForEachSensor) {
  auto log = ScanLog::Open(path_);
  ASSERT_TRUE(log.ok());
  RobotDescription robot;
  robot.name = "r0";
  RangerDescription ranger;
  ranger.name = "ranger:0";
  RangerReading reading;
  reading.scans.push_back({{0.1, 5.0, 1.0 / 3.0}, {}});
  reading.scans.push_back({{2.0}, {}});
  reading.scans.push_back({});
  log.value()->Write(12, robot, ranger, reading);
  EXPECT_FALSE(log.value()->Flush());
  EXPECT_EQ(Text(),
            "{\"tick\":12,\"robot\":\"r0\",\"sensor\":\"ranger:0.0\",\"ranges\":[0.1,5,0.3333333333333333]}\n"
            "{\"tick\":12,\"robot\":\"r0\",\"sensor\":\"ranger:0.1\",\"ranges\":[2]}\n"
            "{\"tick\":12,\"robot\":\"r0\",\"sensor\":\"ranger:0.2\",\"ranges\":[]}\n");
}

TEST_F(ScanLogTest, NamesAreJsonWhateverTheyHold) {
  auto log = ScanLog::Open(path_);
  ASSERT_TRUE(log.ok());
  RobotDescription robot;
  robot.name = "a \"b\"\n\xff";
  RangerReading reading;
  reading.scans.push_back({{1.0}, {}});
  log.value()->Write(0, robot, {}, reading);
  EXPECT_FALSE(log.value()->Flush());
  EXPECT_TRUE(nlohmann::json::accept(Text())) << Text();
}

TEST_F(ScanLogTest, AddsToWholeLinesIfAskedToKeepThem) {
  RangerReading reading;
  reading.scans.push_back({{1.0}, {}});
  for (int tick = 0; tick < 2; ++tick) {  // the first time there is no file
    auto log = ScanLog::Open(path_, true);
    ASSERT_TRUE(log.ok()) << log.error().ToString();
    log.value()->Write(tick, {}, {}, reading);
    EXPECT_FALSE(log.value()->Flush());
    std::ofstream(path_, std::ios::app) << "{\"tick\":9,\"rob";
  }
  auto log = ScanLog::Open(path_, true);
  ASSERT_TRUE(log.ok());
  EXPECT_EQ(Text(),
            "{\"tick\":0,\"robot\":\"\",\"sensor\":\".0\",\"ranges\":[1]}\n"
            "{\"tick\":1,\"robot\":\"\",\"sensor\":\".0\",\"ranges\":[1]}\n");
  EXPECT_TRUE(ScanLog::Open(path_).ok());
  EXPECT_EQ(Text(), "");
}

TEST_F(ScanLogTest, KeepsItsFirstError) {
  auto log = ScanLog::Open("/dev/full");
  ASSERT_TRUE(log.ok());
  RangerReading reading;
  reading.scans.push_back({{1.0}, {}});
  log.value()->Write(0, {}, {}, reading);
  const Status first = log.value()->Flush();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->ToString(), "/dev/full: error: cannot write scans: No space left on device");
  log.value()->Write(1, {}, {}, reading);
  EXPECT_TRUE(log.value()->status());
}

}  // namespace
}  // namespace troupe
