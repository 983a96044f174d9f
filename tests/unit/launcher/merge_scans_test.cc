#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "launcher/supervise/output_files.h"
#include "tests/support/files.h"

namespace troupe {
namespace {

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
