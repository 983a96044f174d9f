#include "launcher/process/process.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/personality.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <system_error>
#include <thread>

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// Starts a shell that runs the script.
Process StartShell(const std::string& script, const LinePipe& output) {
  Result<Process> process = Process::Start({"/bin/sh", "-c", script}, output.writing_end());
  EXPECT_TRUE(process.ok());
  return std::move(process).value();
}

ProcessEnd WaitForEnd(Process& process) {
  for (auto deadline = Clock::now() + std::chrono::seconds(20); !process.Poll() && Clock::now() < deadline;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_FALSE(process.running());
  return process.end().value_or(ProcessEnd{});
}

// The next line that a child prints.
std::string WaitForLine(LinePipe& pipe) {
  pollfd waited{pipe.reading_end(), POLLIN, 0};
  std::vector<std::string> lines;
  while (lines.empty() && poll(&waited, 1, 20000) == 1) lines = pipe.Read();
  return lines.empty() ? "" : lines.front();
}

TEST(Process, HasTheSameAddressesAsOthersOnRequest) {
  const auto personality_of = [](Addresses addresses) {
    LinePipe output;
    Result<Process> process =
        Process::Start({"/bin/cat", "/proc/self/personality"}, output.writing_end(), -1, addresses);
    EXPECT_TRUE(process.ok());
    return std::stoul(WaitForLine(output), nullptr, 16);
  };
  const unsigned long ours = static_cast<unsigned long>(personality(~0u));
  if (personality(ours) < 0) GTEST_SKIP() << "forbidden here";
  EXPECT_EQ(personality_of(Addresses::kRandom), ours);
  EXPECT_EQ(personality_of(Addresses::kSame), ours | ADDR_NO_RANDOMIZE);
}

TEST(Process, EndsWithItsExitStatusAndMemory) {
  LinePipe output;
  Process process = StartShell("exit 7", output);
  ProcessEnd end = WaitForEnd(process);
  EXPECT_EQ(end.exit_code, 7);
  EXPECT_EQ(end.signal, 0);
  EXPECT_GT(end.peak_memory_mib, 0.0);
  EXPECT_EQ(end.ToString(), "ended with exit status 7");
}

TEST(Process, ReportsTheSignalThatEndedIt) {
  LinePipe output;
  Process process = StartShell("kill -9 $$", output);
  ProcessEnd end = WaitForEnd(process);
  EXPECT_EQ(end.signal, SIGKILL);
  EXPECT_EQ(end.exit_code, 128 + SIGKILL);
  EXPECT_EQ(end.ToString(), "was killed by signal 9 (Killed)");
}

TEST(Process, PrintsIntoThePipe) {
  LinePipe output;
  Process process = StartShell("echo out; echo err >&2; printf unfinished", output);
  WaitForEnd(process);
  EXPECT_EQ(output.Read(), (std::vector<std::string>{"out", "err"}));
  output.CloseWritingEnd();
  EXPECT_EQ(output.Read(), (std::vector<std::string>{"unfinished"}));
  EXPECT_TRUE(output.at_end());
}

TEST(Process, KeepsTheGivenDescriptorAndNoOther) {
  LinePipe output;
  LinePipe reports;
  std::string number = std::to_string(reports.writing_end());
  std::string other = std::to_string(reports.reading_end());
  std::string script = "echo report >&" + number + "; test -e /proc/self/fd/" + other + " && exit 1; exit 0";
  Result<Process> process = Process::Start({"/bin/sh", "-c", script}, output.writing_end(), reports.writing_end());
  ASSERT_TRUE(process.ok());
  EXPECT_EQ(WaitForEnd(process.value()).exit_code, 0);
  EXPECT_EQ(reports.Read(), (std::vector<std::string>{"report"}));
}

TEST(Process, IsKilledWithItsWholeGroupWhenItGoesOutOfScope) {
  LinePipe output;
  pid_t grandchild = 0;
  {
    Process process = StartShell("sleep 1000 & echo $!; wait", output);
    grandchild = std::stoi(WaitForLine(output));
    ASSERT_EQ(kill(grandchild, 0), 0);
  }
  // The pipe ends with the last process of the group.
  output.CloseWritingEnd();
  pollfd waited{output.reading_end(), POLLIN, 0};
  ASSERT_EQ(poll(&waited, 1, 20000), 1);
  output.Read();
  EXPECT_TRUE(output.at_end());
}

TEST(Process, DiesWithItsParentEvenIfTheParentIsKilled) {
  LinePipe output;
  pid_t parent = fork();
  ASSERT_GE(parent, 0);
  if (parent == 0) {
    Result<Process> child = Process::Start({"/bin/sleep", "1000"}, output.writing_end());
    (void)!write(output.writing_end(), "up\n", 3);
    pause();
    _exit(0);
  }
  output.CloseWritingEnd();
  ASSERT_EQ(WaitForLine(output), "up");
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  pollfd waited{output.reading_end(), POLLIN, 0};
  ASSERT_EQ(poll(&waited, 1, 20000), 1) << "the child outlived its parent";
  output.Read();
  EXPECT_TRUE(output.at_end());
}

TEST(Process, ReceivesTheSignalsThatItsParentWatches) {
  SignalWatch signals;
  LinePipe output;
  Process process = StartShell("sleep 1000", output);
  process.Signal(SIGTERM);
  EXPECT_EQ(WaitForEnd(process).signal, SIGTERM);
}

TEST(Process, AnEndThatTheSystemDoesNotTellIsNoSuccess) {
  const auto before = signal(SIGCHLD, SIG_IGN);  // no process can wait for its children then
  LinePipe output;
  Process process = StartShell("exit 0", output);
  const ProcessEnd end = WaitForEnd(process);
  signal(SIGCHLD, before);
  EXPECT_FALSE(end.ok());
  EXPECT_EQ(end.ToString(), "ended in an unknown way (No child processes)");
}

TEST(Process, EndsAtOnceWithoutItsStreams) {
  Result<Process> process = Process::Start({"/bin/sh", "-c", "exit 0"}, 9999);
  ASSERT_TRUE(process.ok());
  EXPECT_EQ(WaitForEnd(process.value()).exit_code, 127);
}

// The limit of this process's descriptors; `free` more can be opened.
class FewDescriptors {
 public:
  explicit FewDescriptors(rlim_t free) {
    getrlimit(RLIMIT_NOFILE, &before_);
    const int next = dup(STDOUT_FILENO);
    close(next);
    const rlimit low{static_cast<rlim_t>(next) + free, before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &low);
  }
  ~FewDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }
  FewDescriptors(const FewDescriptors&) = delete;
  FewDescriptors& operator=(const FewDescriptors&) = delete;

 private:
  rlimit before_{};
};

TEST(Process, HasAnEmptyInputAlsoWithoutAFreeDescriptor) {
  LinePipe output;
  Result<Process> process = Failure("not started");
  {
    const FewDescriptors none(0);
    process = Process::Start({"/bin/sh", "-c", "readlink /proc/self/fd/0"}, output.writing_end());
  }
  ASSERT_TRUE(process.ok());
  EXPECT_EQ(WaitForLine(output), "/dev/null");
}

TEST(LinePipe, NeedsDescriptors) {
  const FewDescriptors one(1);
  EXPECT_THROW(LinePipe(), std::system_error);
}

TEST(LineReader, EndsWithWhatCannotBeRead) {
  const int folder = open("/", O_RDONLY | O_CLOEXEC);
  LineReader reader(folder);
  EXPECT_TRUE(reader.Read().empty());
  EXPECT_TRUE(reader.at_end());
  close(folder);
}

TEST(SignalWatch, NeedsADescriptorAndLeavesTheSignalsWithoutOne) {
  sigset_t blocked;
  const FewDescriptors none(0);
  EXPECT_THROW(SignalWatch(), std::system_error);
  ASSERT_EQ(pthread_sigmask(SIG_SETMASK, nullptr, &blocked), 0);
  EXPECT_EQ(sigismember(&blocked, SIGTERM), 0);
}

TEST(SignalWatch, ReportsChildrenWhateverItsParentHasIgnored) {
  const auto before = signal(SIGCHLD, SIG_IGN);
  {
    SignalWatch signals;
    LinePipe output;
    Process process = StartShell("exit 3", output);
    pollfd waited{signals.descriptor(), POLLIN, 0};
    EXPECT_EQ(poll(&waited, 1, 20000), 1);
    EXPECT_EQ(WaitForEnd(process).exit_code, 3);
  }
  signal(SIGCHLD, before);
}

TEST(Process, IsMissingWhenItIsNotBesideTheRunningProgram) {
  Result<std::string> found = FindProgram("no-such-program");
  ASSERT_FALSE(found.ok());
  EXPECT_THAT(found.error().message, testing::HasSubstr("no-such-program"));
  EXPECT_TRUE(FindProgram(std::filesystem::read_symlink("/proc/self/exe").filename()).ok());
}

TEST(SignalWatch, DistinguishesStopRequestsFromEndsOfChildren) {
  SignalWatch signals;
  EXPECT_FALSE(signals.ReadStopRequest());
  raise(SIGCHLD);
  EXPECT_FALSE(signals.ReadStopRequest());
  raise(SIGINT);
  EXPECT_TRUE(signals.ReadStopRequest());
  EXPECT_FALSE(signals.ReadStopRequest());
}

}  // namespace
}  // namespace troupe
