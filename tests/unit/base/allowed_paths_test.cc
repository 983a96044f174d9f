#include <gtest/gtest.h>

#include <filesystem>

#include "common/base/paths.h"
#include "tests/support/files.h"

namespace troupe {
namespace {

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
