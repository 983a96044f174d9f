#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/files.h"
#include "transport/security/session_keys.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kDomain = 42;

class RunKeysFolderTest : public testing::Test {
 protected:
  RunKeysFolderTest() {
    if (const char* before = std::getenv("XDG_RUNTIME_DIR")) before_ = before;
    setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
  }
  ~RunKeysFolderTest() override {
    before_.empty() ? unsetenv("XDG_RUNTIME_DIR") : setenv("XDG_RUNTIME_DIR", before_.c_str(), 1);
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

  const test::TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
  std::string before_;
};

TEST_F(RunKeysFolderTest, DeletesTheKeysThatKilledProcessesHaveLeft) {
  KillAfterPublishing("first");
  ASSERT_EQ(CountFiles(), 2);
  ASSERT_EQ(FindSessionKeys(kDomain).size(), 1u);
  {
    const RunKeysFolder keys = RunKeysFolder::Make().value();
    const PublishedKeys published = PublishedKeys::Publish(kDomain, "second", keys.path()).value();
    EXPECT_EQ(CountFiles(), 2);
    EXPECT_TRUE(fs::exists(keys.path()));
    ASSERT_EQ(FindSessionKeys(kDomain).size(), 1u);
    EXPECT_EQ(FindSessionKeys(kDomain)[0].session, "second");
  }
  EXPECT_EQ(CountFiles(), 0);
}

TEST_F(RunKeysFolderTest, DeletesTheNameThatAKilledServiceHasLeft) {
  {
    const RunKeysFolder keys = RunKeysFolder::Make().value();
    std::filesystem::create_symlink(keys.path(), SessionsFolder().value() + "/42-killed");
    ASSERT_EQ(FindSessionKeys(kDomain).size(), 1u);
  }
  EXPECT_EQ(CountFiles(), 0);
}

TEST_F(RunKeysFolderTest, NamesOfKeysThatExistStay) {
  fs::create_directory(folder_ + "/keys");  // of a user, or of `troupe host`
  const PublishedKeys first = PublishedKeys::Publish(kDomain, "first", folder_ + "/keys").value();
  const PublishedKeys gone = PublishedKeys::Publish(kDomain, "gone", folder_ + "/gone").value();
  ASSERT_EQ(CountFiles(), 2);
  const PublishedKeys second = PublishedKeys::Publish(kDomain, "second", folder_ + "/keys").value();
  EXPECT_EQ(CountFiles(), 2);
  EXPECT_EQ(FindSessionKeys(kDomain).size(), 2u);
}

}  // namespace
}  // namespace troupe
