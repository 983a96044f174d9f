#include "robot-agent/robot/scan_log.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
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

TEST_F(ScanLogTest, AppendsToTheCompleteLinesOfAKeptFile) {
  for (int tick = 0; tick < 2; ++tick) {  // the first time there is no file
    auto log = ScanLog::Open(path_, true);
    ASSERT_TRUE(log.ok()) << log.error().ToString();
    log.value()->Write("{\"tick\":" + std::to_string(tick) + "}\n");
    EXPECT_TRUE(log.value()->Flush().ok());
    std::ofstream(path_, std::ios::app) << "{\"tick\":9,\"rob";
  }
  auto log = ScanLog::Open(path_, true);
  ASSERT_TRUE(log.ok());
  EXPECT_EQ(Text(),
            "{\"tick\":0}\n"
            "{\"tick\":1}\n");
  EXPECT_TRUE(ScanLog::Open(path_).ok());
  EXPECT_EQ(Text(), "");
}

TEST_F(ScanLogTest, MarksARestart) {
  auto log = ScanLog::Open(path_);
  ASSERT_TRUE(log.ok());
  log.value()->Write("{\"tick\":5}\n");
  log.value()->Restart(3);
  log.value()->Write("{\"tick\":0}\n");
  EXPECT_TRUE(log.value()->Flush().ok());
  EXPECT_EQ(Text(), "{\"tick\":5}\n{\"edition\":3}\n{\"tick\":0}\n");
}

TEST_F(ScanLogTest, KeepsItsFirstError) {
  auto log = ScanLog::Open("/dev/full");
  ASSERT_TRUE(log.ok());
  log.value()->Write("{\"tick\":0}\n");
  const Status first = log.value()->Flush();
  ASSERT_FALSE(first.ok());
  EXPECT_EQ(first.error().ToString(), "/dev/full: error: cannot write scans: No space left on device");
  log.value()->Write("{\"tick\":1}\n");
  EXPECT_FALSE(log.value()->status().ok());
}

}  // namespace
}  // namespace troupe
