// Saving never destroys a file, and history returns to each text.
#include "viewer/editor/edited_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>

#include "tests/support/files.h"

namespace troupe {
namespace {

EditedFile Opened(const std::string& path, const std::string& initial = "") {
  Result<EditedFile> file = EditedFile::Open(path, initial);
  EXPECT_TRUE(file.ok()) << (file.ok() ? "" : file.error().ToString());
  return std::move(file).value();
}

TEST(EditedFileTest, SavedTextReplacesTheFileAsAWhole) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write("a.world", "old\n");
  chmod(path.c_str(), 0640);
  EditedFile file = Opened(path);
  EXPECT_FALSE(file.is_modified({}));
  file.Change("new\n", "the change");
  EXPECT_TRUE(file.is_modified({}));
  EXPECT_EQ(folder.Read("a.world"), "old\n");
  ASSERT_TRUE(file.Save(false, {}).ok());
  EXPECT_EQ(folder.Read("a.world"), "new\n");
  EXPECT_FALSE(file.is_modified({}));
  struct stat status {};
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0640U);
  EXPECT_EQ(folder.size(), 1U);
}

TEST(EditedFileTest, ALinkStaysALink) {
  const test::TemporaryFolder folder;
  folder.Write("a.world", "old\n");
  std::filesystem::create_symlink("a.world", folder / "link.world");
  EditedFile file = Opened(folder / "link.world");
  file.Change("new\n", "the change");
  ASSERT_TRUE(file.Save(false, {}).ok());
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.world"));
  EXPECT_EQ(folder.Read("a.world"), "new\n");
}

TEST(EditedFileTest, AFileThatHasChangedOnDiskIsKept) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write("a.world", "old\n");
  EditedFile file = Opened(path);
  file.Change("mine\n", "the change");
  folder.Write("a.world", "theirs\n");
  const Status refused = file.Save(false, {});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kNoRoom);
  EXPECT_EQ(folder.Read("a.world"), "theirs\n");
  ASSERT_TRUE(file.Reload().ok());
  EXPECT_EQ(file.text(), "theirs\n");
  file.Undo();
  EXPECT_EQ(file.text(), "mine\n");
  ASSERT_TRUE(file.Save(false, {}).ok());
  std::filesystem::remove(path);
  EXPECT_FALSE(file.Save(false, {}).ok());
  EXPECT_TRUE(file.Save(true, {}).ok());
}

TEST(EditedFileTest, ANewFileDoesNotReplaceOneThatAppeared) {
  const test::TemporaryFolder folder;
  EditedFile file = Opened(folder / "new.world", "");
  EXPECT_TRUE(file.is_modified({}));
  folder.Write("new.world", "theirs\n");
  EXPECT_FALSE(file.Save(false, {}).ok());
  EXPECT_EQ(folder.Read("new.world"), "theirs\n");
  EXPECT_FALSE(EditedFile::Open(folder / "none/new.world", "").ok());
}

// A write that fails half-way, as on a full disk.
TEST(EditedFileTest, AFullDiskLeavesTheFileAsItWas) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write("a.world", "old\n");
  EditedFile file = Opened(path);
  file.Change(std::string(100'000, '#'), "the change");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit small = before;
  small.rlim_cur = 4096;
  setrlimit(RLIMIT_FSIZE, &small);
  const Status saved = file.Save(false, {});
  setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(saved.ok());
  EXPECT_EQ(saved.error().code, ErrorCode::kOutputFailed);
  EXPECT_EQ(folder.Read("a.world"), "old\n");
  EXPECT_EQ(folder.size(), 1U);
  EXPECT_TRUE(file.is_modified({}));
  EXPECT_TRUE(file.Save(false, {}).ok());
}

TEST(EditedFileTest, HistoryIsBounded) {
  const test::TemporaryFolder folder;
  EditedFile file = Opened(folder / "new.world", "");
  for (std::size_t i = 0; i < 2 * EditedFile::kMostStates; ++i) file.Change(std::to_string(i), "edit");
  std::size_t undone = 0;
  for (; file.undo_label(); ++undone) file.Undo();
  EXPECT_EQ(undone, EditedFile::kMostStates - 1);
}

}  // namespace
}  // namespace troupe
