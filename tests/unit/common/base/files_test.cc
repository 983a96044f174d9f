#include "tests/support/files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "common/base/output_file.h"
#include "common/base/paths.h"

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

namespace fs = std::filesystem;

// A tree of files: own/a.world, own/below/b.world, own2/c.world, and links to them.
class AllowedPathsTest : public testing::Test, public test::TemporaryFolder {
 protected:
  void SetUp() override {
    for (const char* file : {"own/a.world", "own/below/b.world", "own2/c.world"}) Write(file, "x");
    fs::create_symlink("../own2/c.world", Path("own/link.world"));
    fs::create_symlink("../own2", Path("own/link"));
    fs::create_symlink("own", Path("inward"));
    fs::create_symlink("self", Path("self"));
    allowed_.Add(Path("own"));
  }
  std::string Resolved(const std::string& name) const { return allowed_.Resolve(Path(name)).value_or("refused"); }

  AllowedPaths allowed_;
};

TEST_F(AllowedPathsTest, AllowsNothingAtFirst) {
  EXPECT_EQ(AllowedPaths().Resolve(Path("own/a.world")), std::nullopt);
}

TEST_F(AllowedPathsTest, AllAllowsEveryPathAsItIs) {
  EXPECT_EQ(AllowedPaths::All().Resolve("x/../y"), "x/../y");
}

TEST_F(AllowedPathsTest, AFolderAllowsAllBelowIt) {
  EXPECT_EQ(Resolved("own/a.world"), Path("own/a.world"));
  EXPECT_EQ(Resolved("own/below/../below/b.world"), Path("own/below/b.world"));
  EXPECT_EQ(Resolved("own/missing.world"), Path("own/missing.world"));
  EXPECT_EQ(Resolved("inward/a.world"), Path("own/a.world"));
}

TEST_F(AllowedPathsTest, NothingElseIsAllowed) {
  EXPECT_EQ(Resolved("own2/c.world"), "refused");
  EXPECT_EQ(Resolved("own/../own2/c.world"), "refused");
  EXPECT_EQ(Resolved("self"), "refused");
  EXPECT_EQ(allowed_.Resolve("/etc/passwd"), std::nullopt);
  EXPECT_EQ(allowed_.Resolve(""), std::nullopt);
}

TEST_F(AllowedPathsTest, LinksCountForTheFileThatTheyLeadTo) {
  EXPECT_EQ(Resolved("own/link.world"), "refused");
  EXPECT_EQ(Resolved("own/link/c.world"), "refused");
  EXPECT_EQ(Resolved("own/link/missing.world"), "refused");
  allowed_.Add(Path("own/link/"));
  EXPECT_EQ(Resolved("own/link.world"), Path("own2/c.world"));
  EXPECT_EQ(allowed_.paths(), (std::vector<std::string>{Path("own"), Path("own2")}));
}

TEST_F(AllowedPathsTest, AFileAllowsItselfOnly) {
  AllowedPaths allowed;
  allowed.Add(Path("own/a.world"));
  EXPECT_TRUE(allowed.Resolve(Path("own/a.world")));
  EXPECT_FALSE(allowed.Resolve(Path("own/below/b.world")));
  const fs::path before = fs::current_path();
  fs::current_path(Path("own"));
  EXPECT_EQ(allowed.Resolve("a.world"), Path("own/a.world"));
  fs::current_path(before);
}

TEST_F(AllowedPathsTest, TheRootAllowsEverything) {
  AllowedPaths allowed;
  allowed.Add("/");
  EXPECT_EQ(allowed.Resolve(Path("own2/c.world")), Path("own2/c.world"));
}

}  // namespace
}  // namespace troupe
