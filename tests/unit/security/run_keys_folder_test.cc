#include "common/security/run_keys_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "common/security/session_keys.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kDomain = 42;

class RunKeysFolderTest : public testing::Test {
 protected:
  RunKeysFolderTest() {
    EXPECT_NE(mkdtemp(folder_.data()), nullptr);
    if (const char* before = std::getenv("XDG_RUNTIME_DIR")) before_ = before;
    setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
  }
  ~RunKeysFolderTest() override {
    before_.empty() ? unsetenv("XDG_RUNTIME_DIR") : setenv("XDG_RUNTIME_DIR", before_.c_str(), 1);
    fs::remove_all(folder_);
  }

  // A process makes keys, publishes them, and is killed.
  static void KillAfterPublishing(const std::string& session) {
    const pid_t child = fork();
    if (child == 0) {
      const Result<RunKeysFolder> keys = RunKeysFolder::Make();
      const Result<PublishedKeys> published =
          keys.ok() ? PublishedKeys::Publish(kDomain, session, keys.value().path()) : keys.error();
      _exit(published.ok() ? 0 : 1);  // without destructors
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_EQ(status, 0);
  }
  std::ptrdiff_t CountFiles() const {
    return std::distance(fs::directory_iterator(SessionsFolder().value()), fs::directory_iterator());
  }

  std::string folder_ = testing::TempDir() + "keys-XXXXXX";
  std::string before_;
};

TEST_F(RunKeysFolderTest, DeletesTheKeysAndNamesThatKilledProcessesHaveLeft) {
  KillAfterPublishing("first");
  ASSERT_EQ(CountFiles(), 2);
  ASSERT_EQ(FindSessionKeys(kDomain).size(), 1u);
  {
    const Result<RunKeysFolder> keys = RunKeysFolder::Make();
    ASSERT_TRUE(keys.ok()) << keys.error().message;
    EXPECT_EQ(CountFiles(), 1);
    EXPECT_TRUE(fs::exists(keys.value().path()));
  }
  EXPECT_EQ(CountFiles(), 0);
}

TEST_F(RunKeysFolderTest, KeepsTheNamesOfLiveProcessesAndOfKeysElsewhere) {
  const RunKeysFolder live = RunKeysFolder::Make().value();
  const PublishedKeys published = PublishedKeys::Publish(kDomain, "live", live.path()).value();
  // Of a user, on a disk that is not mounted now.
  const PublishedKeys elsewhere = PublishedKeys::Publish(kDomain, "elsewhere", folder_ + "/absent/keys-1-x").value();
  const RunKeysFolder other = RunKeysFolder::Make().value();
  EXPECT_EQ(CountFiles(), 4);
  EXPECT_EQ(FindSessionKeys(kDomain).size(), 1u);
}

}  // namespace
}  // namespace troupe
