// Outputs that are inputs, or one file, by whatever paths.
#include "common/base/distinct_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

class DistinctFilesTest : public testing::Test {
 protected:
  DistinctFilesTest() {
    folder_.Write("sub/input", "content");
    folder_.Write("empty", "");
    std::filesystem::create_symlink("sub/input", folder_.Path("link"));
    std::filesystem::create_directory_symlink("sub", folder_.Path("linked"));
    std::filesystem::create_hard_link(folder_.Path("sub/input"), folder_.Path("other"));
  }

  // "" if the outputs may be written.
  std::string Check(const std::vector<OutputName>& outputs) {
    const Status status = CheckDistinct(outputs, [&] {
      ++asked_;
      return std::vector{folder_.Path("sub/input"), folder_.Path("empty")};
    });
    return status.ok() ? "" : status.error().ToString();
  }

  TemporaryFolder folder_;
  int asked_ = 0;
};

TEST_F(DistinctFilesTest, NoOutputIsAnInputByWhateverPath) {
  for (const char* name : {"sub/input", "sub/../sub/./input", "link", "linked/input", "other"}) {
    EXPECT_THAT(Check({{"-o", folder_.Path("new")}, {"--poses", folder_.Path(name)}}),
                HasSubstr("--poses: found " + folder_.Path(name) + ", which the command reads"));
  }
  EXPECT_EQ(asked_, 5);
}

TEST_F(DistinctFilesTest, InputsAreAskedForOnlyIfAnOutputHasContent) {
  EXPECT_EQ(Check({{"-o", folder_.Path("new")}, {"--poses", ""}, {"--scans", folder_.Path("empty")}}), "");
  EXPECT_EQ(Check({{"-o", "/dev/null"}, {"--poses", "/dev/null"}, {"--scans", folder_.path()}}), "");
  EXPECT_EQ(asked_, 0);
  folder_.Write("old", "of an earlier command");
  EXPECT_EQ(Check({{"-o", folder_.Path("old")}}), "");
  EXPECT_EQ(asked_, 1);
}

TEST_F(DistinctFilesTest, NoTwoOutputsAreOneFile) {
  const std::vector<std::pair<std::string, std::string>> pairs = {
      {"new", "sub/../new"}, {"sub/new", "linked/new"}, {"link", "other"}, {"new", "new"}};
  for (const auto& [a, b] : pairs) {
    EXPECT_THAT(Check({{"--poses", folder_.Path(a)}, {"", ""}, {"--scans", folder_.Path(b)}}),
                HasSubstr("--poses and --scans name the same file"));
  }
}

}  // namespace
}  // namespace troupe::test
