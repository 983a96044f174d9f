#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "common/base/file.h"
#include "launcher/hosts/connect_hosts.h"
#include "launcher/hosts/host.h"
#include "launcher/hosts/remote_host.h"
#include "tests/support/files.h"
#include "tests/support/without_memory.h"
#include "troupe/version.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

class HostFolderTest : public testing::Test {
 protected:
  HostFolderTest() {
    const char* const before = std::getenv("TMPDIR");
    if (before != nullptr) before_ = before;
    setenv("TMPDIR", temporary_.c_str(), 1);
  }
  ~HostFolderTest() override {
    if (before_) {
      setenv("TMPDIR", before_->c_str(), 1);
    } else {
      unsetenv("TMPDIR");
    }
  }

  // Its folder, with a file in it. The process is `process`.
  std::string FolderOfAnotherHost() {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    process_ = fork();
    if (process_ == 0) {
      const HostFolder folder;
      std::ofstream(folder.path() + "/service-hashes") << "1";
      const std::string line = folder.path() + "\n";
      if (write(ends[1], line.data(), line.size()) < 0) _exit(1);
      for (;;) pause();
    }
    close(ends[1]);
    std::string path;
    for (char letter = 0; read(ends[0], &letter, 1) == 1 && letter != '\n';) path += letter;
    close(ends[0]);
    return path;
  }
  void KillOtherHost() const {
    kill(process_, SIGKILL);
    EXPECT_EQ(waitpid(process_, nullptr, 0), process_);
  }
  std::string MakeFolder(const std::string& name) const {
    folder_.Write(name + "/file", "1");
    return folder_.Path(name);
  }

  const test::TemporaryFolder folder_;
  const std::string temporary_ = folder_.path();
  std::optional<std::string> before_;
  pid_t process_ = -1;
};

TEST_F(HostFolderTest, IsDeletedWithoutMemory) {
  std::optional<HostFolder> folder(std::in_place);
  const std::string path = folder->path();
  std::ofstream(path + "/service-hashes") << "1";
  EXPECT_EQ(test::StatusWithoutMemory([&] { folder.reset(); }), 0);
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(HostFolderTest, ExistsAsLongAsItsHost) {
  std::string path;
  {
    const HostFolder folder;
    path = folder.path();
    EXPECT_EQ(fs::path(path).parent_path(), temporary_);
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
    const HostFolder another;
    EXPECT_NE(another.path(), path);
    EXPECT_TRUE(fs::is_directory(path));
  }
  EXPECT_TRUE(fs::is_empty(temporary_));
}

TEST_F(HostFolderTest, OfAKilledHostIsDeletedByTheNext) {
  const std::string left = FolderOfAnotherHost();
  ASSERT_TRUE(fs::exists(left + "/service-hashes"));
  { const HostFolder while_it_runs; }
  EXPECT_TRUE(fs::exists(left + "/service-hashes"));
  KillOtherHost();
  EXPECT_TRUE(fs::exists(left + "/service-hashes"));
  const HostFolder next;
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(next.path()));
}

TEST_F(HostFolderTest, NoLinkIsFollowedOrDeleted) {
  const std::string target = MakeFolder("target");
  const std::string link = temporary_ + "/troupe-host-1-abcdef";
  fs::create_symlink(target, link);
  const std::string left = MakeFolder("troupe-host-2-abcdef");
  fs::create_symlink(target, left + "/link");
  const HostFolder folder;
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(target + "/file"));
}

TEST_F(HostFolderTest, OthersAreNotDeleted) {
  const std::string other_user = MakeFolder("troupe-host-3-abcdef");
  // Only root can give a folder away, and in a user namespace only to users that it has.
  const bool is_of_another = chown(other_user.c_str(), 65534, 65534) == 0;
  if (!is_of_another) {
    ASSERT_EQ(errno, geteuid() == 0 ? EINVAL : EPERM);
  }
  for (const char* name : {"troupe-host-abcdef", "troupe-host-", "troupe-host-1", "troupe-host-1-",
                           "troupe-host-x-abcdef", "troupe-host-1-abcdefg", "host-1-abcdef"}) {
    MakeFolder(name);
  }
  std::ofstream(temporary_ + "/troupe-host-4-abcdef") << "a file";
  { const HostFolder folder; }
  EXPECT_EQ(fs::exists(other_user + "/file"), is_of_another);
  EXPECT_EQ(std::distance(fs::directory_iterator(temporary_), {}), is_of_another ? 9 : 8);
}

TEST_F(HostFolderTest, TakesOverFromAHostThatServesTheSame) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  pid_t hosts[2];
  const char* const names[2] = {"run/h1", "run/h2"};
  for (int i = 0; i < 2; ++i) {
    hosts[i] = fork();
    if (hosts[i] != 0) continue;
    HostFolder folder;
    folder.TakeOver(names[i]);
    if (write(ends[1], "x", 1) != 1) _exit(1);
    for (;;) pause();
  }
  for (int i = 0; i < 2; ++i) {
    char ready = 0;
    ASSERT_EQ(read(ends[0], &ready, 1), 1);
  }
  HostFolder folder;
  folder.TakeOver("run/h1");
  int status = 0;
  EXPECT_EQ(waitpid(hosts[0], &status, 0), hosts[0]);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(waitpid(hosts[1], &status, WNOHANG), 0) << "it serves another run";
  EXPECT_EQ(std::distance(fs::directory_iterator(temporary_), fs::directory_iterator()), 2);
  kill(hosts[1], SIGKILL);
  waitpid(hosts[1], nullptr, 0);
  close(ends[0]);
  close(ends[1]);
}

// As sshd connects `troupe host`: its input and its output are one socket, and the input is read without waiting.
TEST(HostMessages, AreWrittenAsAWholeWhereTheReaderIsSlow) {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
  ASSERT_EQ(fcntl(ends[0], F_SETFL, O_NONBLOCK), 0);
  const std::string text(10'000'000, 'x');
  std::size_t received = 0;
  std::thread reader([&] {
    std::string buffer(65536, ' ');
    for (ssize_t size = 0; (size = read(ends[1], buffer.data(), buffer.size())) > 0;) {
      received += static_cast<std::size_t>(size);
    }
  });
  EXPECT_TRUE(WriteAll(ends[0], text));
  close(ends[0]);
  reader.join();
  close(ends[1]);
  EXPECT_EQ(received, text.size());
}

// A host that first writes messages, more than a pipe holds, and then reads its requests, as many as that.
TEST(RemoteHostTest, TakesMessagesWhileTheHostTakesNoRequests) {
  const test::TemporaryFolder folder;
  const std::string requests = folder / "requests";
  HostSettings settings;
  settings.name = "slow";
  settings.start = "echo '{\"host\":\"" + std::string(VersionText()) +
                   "\",\"folder\":\"/\",\"programs\":\"/\"}'; seq -w 100001 150000; cat >" + requests;
  Result<std::unique_ptr<RemoteHost>> connection = RemoteHost::Connect(settings, "run");
  ASSERT_TRUE(connection.ok());
  RemoteHost& host = *connection.value();
  while (!host.connected()) {
    pollfd waited{host.descriptors().front(), POLLIN, 0};
    ASSERT_EQ(poll(&waited, 1, 30'000), 1);
    host.Receive();
    ASSERT_TRUE(host.PollLoss().ok());
  }
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(host.Start("robot-agent", {std::string(4000, 'x')}, false).ok());
  host.Receive();
  EXPECT_THAT(host.ReadOutput(), testing::SizeIs(50'000));
  connection.value().reset();
  EXPECT_THAT(test::LinesOf(test::TextOf(requests)), testing::SizeIs(101));  // the first one names the run
}

using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<std::string> kRobots = {"a0", "b0", "a1", "b1", "c0"};

HostSettings Host(const std::string& name) {
  HostSettings host;
  host.name = name;
  return host;
}

HostSettings Counting(const std::string& name, std::uint32_t count) {
  HostSettings host = Host(name);
  host.robot_count = count;
  return host;
}

HostSettings Naming(const std::string& name, std::vector<std::string> robots) {
  HostSettings host = Host(name);
  host.robot_names = std::move(robots);
  return host;
}

TEST(PlaceRobots, DividesRobotsIntoEqualBlocks) {
  EXPECT_THAT(PlaceRobots(kRobots, {Host("x"), Host("y")}).value(), ElementsAre(0u, 0u, 0u, 1u, 1u));
}

TEST(PlaceRobots, PlacesNamedRobotsFirstThenCountedOnesThenTheRest) {
  const auto places = PlaceRobots(kRobots, {Host("rest"), Counting("two", 2), Naming("as", {"a*"})});
  EXPECT_THAT(places.value(), ElementsAre(2u, 1u, 2u, 1u, 0u));
}

TEST(PlaceRobots, LeavesAHostWithCountZeroIdle) {
  EXPECT_THAT(PlaceRobots(kRobots, {Counting("service", 0), Host("x")}).value(), ElementsAre(1u, 1u, 1u, 1u, 1u));
}

TEST(PlaceRobots, NamesUnknownRobotsAndMissingHosts) {
  EXPECT_THAT(PlaceRobots(kRobots, {Counting("x", 3)}).error().message, HasSubstr("hosts for 3 of 5 robots"));
  EXPECT_THAT(PlaceRobots(kRobots, {Naming("x", {"a7"}), Host("y")}).error().message,
              HasSubstr("host x: found no robot named 'a7'"));
}

}  // namespace
}  // namespace troupe
