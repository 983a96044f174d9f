#include <gtest/gtest.h>

#include "robot-agent/robot/robot.h"
#include "tests/support/files.h"
#include "tests/support/values.h"

namespace troupe {
namespace {

class ScanLogTest : public ::testing::Test {
 protected:
  std::string Text() const { return test::TextOf(path_); }

  const test::TemporaryFolder folder_;
  const std::string path_ = folder_.Path("scans");
};

TEST_F(ScanLogTest, AppendsToTheCompleteLinesOfAKeptFile) {
  for (int tick = 0; tick < 2; ++tick) {  // the first time there is no file
    auto log = test::ValueOf(ScanLog::Open(path_, true));
    log->Write("{\"tick\":" + std::to_string(tick) + "}\n");
    EXPECT_TRUE(log->Flush().ok());
    std::ofstream(path_, std::ios::app) << "{\"tick\":9,\"rob";
  }
  test::ValueOf(ScanLog::Open(path_, true));
  EXPECT_EQ(Text(),
            "{\"tick\":0}\n"
            "{\"tick\":1}\n");
  EXPECT_TRUE(ScanLog::Open(path_).ok());
  EXPECT_EQ(Text(), "");
}

TEST_F(ScanLogTest, MarksARestart) {
  auto log = test::ValueOf(ScanLog::Open(path_));
  log->Write("{\"tick\":5}\n");
  log->Restart(3);
  log->Write("{\"tick\":0}\n");
  EXPECT_TRUE(log->Flush().ok());
  EXPECT_EQ(Text(), "{\"tick\":5}\n{\"edition\":3}\n{\"tick\":0}\n");
}

TEST_F(ScanLogTest, KeepsItsFirstError) {
  auto log = test::ValueOf(ScanLog::Open("/dev/full"));
  log->Write("{\"tick\":0}\n");
  const Status first = log->Flush();
  ASSERT_FALSE(first.ok());
  EXPECT_EQ(first.error().ToString(), "/dev/full: error: cannot write scans: No space left on device");
  log->Write("{\"tick\":1}\n");
  EXPECT_FALSE(log->status().ok());
}

}  // namespace
}  // namespace troupe
