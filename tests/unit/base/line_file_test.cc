#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdio>
#include <fstream>

#include "common/base/output_file.h"

namespace troupe {
namespace {

class LineFileTest : public testing::Test {
 protected:
  LineFileTest() { std::remove(path_.c_str()); }
  ~LineFileTest() override { std::remove(path_.c_str()); }

  void Write(const std::string& text) const { std::ofstream(path_) << text; }
  long long Blocks() const {
    struct stat status {};
    stat(path_.c_str(), &status);
    return status.st_blocks;
  }

  const std::string path_ = testing::TempDir() + "/line_file_test";
};

TEST_F(LineFileTest, ReadsWholeLines) {
  Write("one\n\nthree\nunfinished");
  Result<LineFile> file = LineFile::Open(path_, LineFile::Space::kKeep);
  ASSERT_TRUE(file.ok());
  std::string line;
  ASSERT_TRUE(file.value().Next(line));
  EXPECT_EQ(line, "one");
  ASSERT_TRUE(file.value().Next(line));
  EXPECT_EQ(line, "");
  ASSERT_TRUE(file.value().Next(line));
  EXPECT_EQ(line, "three");
  EXPECT_FALSE(file.value().Next(line));
  EXPECT_FALSE(file.value().Next(line));
}

TEST_F(LineFileTest, ReadsLinesThatAreLongerThanAPiece) {
  const std::string lengthy(200'000, 'x');
  Write("a\n" + lengthy + "\nb\n");
  Result<LineFile> file = LineFile::Open(path_, LineFile::Space::kKeep);
  std::string line;
  for (const std::string& expected : {std::string("a"), lengthy, std::string("b")}) {
    ASSERT_TRUE(file.value().Next(line));
    EXPECT_EQ(line, expected);
  }
  EXPECT_FALSE(file.value().Next(line));
}

TEST_F(LineFileTest, FreesTheSpaceThatItHasRead) {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += "line " + std::to_string(i) + "\n";
  Write(text);
  const long long blocks = Blocks();
  Result<LineFile> file = LineFile::Open(path_, LineFile::Space::kFree);
  std::string line;
  for (int i = 0; i < 100'000; ++i) {
    ASSERT_TRUE(file.value().Next(line));
    ASSERT_EQ(line, "line " + std::to_string(i));
  }
  EXPECT_FALSE(file.value().Next(line));
  if (Blocks() == blocks) GTEST_SKIP() << "the file system of " << path_ << " cannot free parts of a file";
  EXPECT_LE(Blocks(), 8);
}

TEST_F(LineFileTest, TellsAnEndFromAFailure) {
  Result<LineFile> folder = LineFile::Open("/", LineFile::Space::kKeep);  // opens, and cannot be read
  ASSERT_TRUE(folder.ok());
  std::string line;
  EXPECT_FALSE(folder.value().Next(line));
  ASSERT_FALSE(folder.value().status().ok());
  EXPECT_EQ(folder.value().status().error().ToString(), "/: error: cannot read: Is a directory");
}

TEST_F(LineFileTest, NamesAFileThatCannotBeRead) {
  const Result<LineFile> file = LineFile::Open(path_, LineFile::Space::kKeep);
  ASSERT_FALSE(file.ok());
  EXPECT_EQ(file.error().ToString(), path_ + ": error: cannot read: No such file or directory");
}

}  // namespace
}  // namespace troupe
