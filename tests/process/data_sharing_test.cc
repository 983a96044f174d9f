// Whole runs with and without shared memory between their processes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <set>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/memory_maps.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string HashLogOf(const std::vector<std::string>& options) {
  const TemporaryFolder folder;
  const std::string run = OutputOf(RunPen(Words("--ticks 100 --hash-log %", {folder.Path("hashes")}) + options));
  EXPECT_EQ(run.find("no data sharing"), std::string::npos);
  return folder.Read("hashes");
}

// The memory of this name that a process maps, by inode.
std::set<std::string> SharedMemoryOf(pid_t process, const std::string& sought = "frames") {
  std::set<std::string> inodes;
  for (const MappedArea& area : MapsOf(process)) {
    if (area.name == "/memfd:troupe-" + sought) inodes.insert(area.inode);
  }
  return inodes;
}

// The number of stacks of threads: each has a guard page, and a thread that has ended keeps its stack until it is
// joined.
int CountStacks(pid_t process) {
  int guards = 0;
  for (const MappedArea& area : MapsOf(process)) {
    if (area.access == "---p" && area.end - area.begin == static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE))) ++guards;
  }
  return guards;
}

TEST(DataSharing, GivesTheHashesOfRunsWithoutIt) {
  const std::string expected = HashLogOf({"--in-process", "--threads", "1"});
  ASSERT_NE(expected, "");
  EXPECT_EQ(HashLogOf({"--in-process", "--threads", "2"}), expected);
  EXPECT_EQ(HashLogOf({"--data-sharing", "on"}), expected);
  EXPECT_EQ(HashLogOf({"--data-sharing", "off"}), expected);
  EXPECT_EQ(HashLogOf({"--data-sharing", "on", "--robots-per-process", "3", "--threads", "2"}), expected);
  EXPECT_EQ(HashLogOf({"--security", "on"}), expected);
}

TEST(DataSharing, IsUsedByAllProcessesOfAMachineUnlessItIsOff) {
  for (const bool on : {true, false}) {
    Program run = RunPen({"--speed", "1", "--data-sharing", on ? "on" : "off"});
    run.WaitForLine("4 robots in 4 agent processes, ready");
    std::vector<pid_t> processes = ChildrenWith(run, "robot-agent");
    EXPECT_EQ(processes.size(), 4u);
    for (const pid_t service : ChildrenWith(run, "world-service")) processes.push_back(service);
    EXPECT_EQ(processes.size(), 5u);
    // The world, once for all.
    const std::set<std::string> world = SharedMemoryOf(processes.back(), "world");
    EXPECT_EQ(world.size(), on ? 1u : 0u);
    for (const pid_t process : processes) {
      EXPECT_EQ(!SharedMemoryOf(process).empty(), on) << CommandLineOf(process);
      EXPECT_EQ(SharedMemoryOf(process, "world"), world) << CommandLineOf(process);
    }
    run.Signal(SIGINT);
    run.Wait();
  }
}

// Kills the service of a run, and waits until the agents map the memory of the next one, and no other.
void ReplaceService(const Program& run) {
  const std::vector<pid_t> killed = ChildrenWith(run, "world-service");
  ASSERT_EQ(killed.size(), 1u);
  const std::set<std::string> before = SharedMemoryOf(killed[0]);
  EXPECT_EQ(before.size(), 1u);
  kill(killed[0], SIGKILL);
  std::set<std::string> after;
  ASSERT_TRUE(Eventually([&] {
    for (const pid_t service : ChildrenWith(run, "world-service")) {
      if (service != killed[0]) after = SharedMemoryOf(service);
    }
    return !after.empty();
  }));
  EXPECT_NE(after, before);
  const std::vector<pid_t> agents = ChildrenWith(run, "robot-agent");
  EXPECT_EQ(agents.size(), 4u);
  // The lease of the killed service may expire after the agents have joined the next one.
  for (const pid_t agent : agents) EXPECT_TRUE(Eventually([&] { return SharedMemoryOf(agent) == after; }));
}

TEST(DataSharing, AgentsKeepNoMemoryAndNoThreadForAKilledService) {
  constexpr int kKills = 4;
  Program run = RunPen({"--speed", "1", "--lease", "0.5"});
  run.WaitForLine("4 robots in 4 agent processes, ready");
  ReplaceService(run);  // the thread of the killed service may be joined when the next one is killed
  const std::vector<pid_t> agents = ChildrenWith(run, "robot-agent");
  std::vector<int> before;
  for (const pid_t agent : agents) before.push_back(CountStacks(agent));
  for (int i = 0; i < kKills; ++i) ReplaceService(run);
  for (std::size_t i = 0; i < agents.size(); ++i) {
    EXPECT_GT(before[i], 0);
    EXPECT_LT(CountStacks(agents[i]), before[i] + kKills - 1) << "stacks of ended threads";
  }
  run.Signal(SIGINT);
  run.Wait();
}

// With too few addresses (ulimit -v, KiB) for all shared memory, or for that of the world.
TEST(DataSharing, WithoutRoomForItGivesTheSameHashes) {
  if (!kCanLimitMemory) GTEST_SKIP() << "sanitizers need more addresses than a limit leaves";
  const std::string expected = HashLogOf({"--in-process"});
  const std::vector<std::pair<std::string, std::string>> notice_by_limit = {{"6000000", "no data sharing: "},
                                                                            {"15000000", "data sharing ends: "}};
  for (const auto& [limit, notice] : notice_by_limit) {
    const TemporaryFolder folder;
    const std::string command = "ulimit -v " + limit + " && exec \"$0\" \"$@\"";
    const std::string output = OutputOf(
        Program(Words("/bin/sh -c % % run % --ticks 100 --speed max --headless --no-ros --domain % --hash-log %",
                      {command, ProgramPath("troupe"), WorldPath("pen.world"), std::to_string(TestDomain()),
                       folder.Path("hashes")})));
    EXPECT_THAT(output, HasSubstr(notice)) << limit;
    EXPECT_EQ(folder.Read("hashes"), expected) << limit;
  }
}

// Three agents read the world and frames in place, and one cannot.
TEST(DataSharing, AnAgentThatCannotShareGivesTheSameHashes) {
  if (!kCanLimitMemory) GTEST_SKIP() << "sanitizers need more addresses than a limit leaves";
  const std::string expected = HashLogOf({"--in-process"});
  const TemporaryFolder folder;
  const std::string session = TestSession("one-without");
  const std::string domain = std::to_string(TestDomain());
  Program service(
      Words("% % --session % --domain % --lease 5 --hash-log % --ticks 100",
            {ProgramPath("world-service"), WorldPath("pen.world"), session, domain, folder.Path("hashes")}));
  std::vector<Program> agents;
  for (const std::string robot : {"r0", "r1", "r2", "r3"}) {
    const std::string limit = robot == "r3" ? "ulimit -v 6000000 && " : "";
    agents.emplace_back(Words("/bin/sh -c % % --session % --domain % --lease 5 --robot %",
                              {limit + "exec \"$0\" \"$@\"", ProgramPath("robot-agent"), session, domain, robot}));
  }
  EXPECT_EQ(service.Wait(), 0) << service.output();
  for (Program& agent : agents) EXPECT_EQ(agent.Wait(), 0) << agent.output();
  EXPECT_THAT(agents[3].output(), HasSubstr("no data sharing with the world service"));
  EXPECT_THAT(agents[0].output(), Not(HasSubstr("no data sharing")));
  EXPECT_EQ(folder.Read("hashes"), expected);
}

TEST(DataSharing, AgentsFollowEditsInPlace) {
  const std::string session = TestSession("edits");
  Program run = RunPen({"--speed", "5", "--session", session});
  run.WaitForLine("4 robots in 4 agent processes, ready");
  const std::vector<pid_t> agents = ChildrenWith(run, "robot-agent");
  ASSERT_EQ(agents.size(), 4u);
  const std::set<std::string> before = SharedMemoryOf(agents[0], "world");
  ASSERT_EQ(before.size(), 1u);
  OutputOf(Ctl(session, {"spawn", "rover", "--name", "r9", "--pose=0,-2,0,0"}));
  // Robots may refer to the world that they were made in.
  for (const pid_t agent : agents) {
    EXPECT_TRUE(Eventually([&] { return SharedMemoryOf(agent, "world").size() == 2; }))
        << "the agent has the new world";
  }
  run.Interrupt();
}

TEST(DataSharing, LeavesNoProcessOfAKilledLauncher) {
  Program run = RunPen({"--speed", "1"});
  run.WaitForLine("4 robots in 4 agent processes, ready");
  const std::vector<pid_t> processes = ChildrenOf(run.pid());
  run.Signal(SIGKILL);
  for (const pid_t process : processes) EXPECT_TRUE(IsGoneSoon(process));
}

TEST(DataSharing, RefusesOtherValues) {
  EXPECT_THAT(OutputOf(Troupe({"run", "x.world", "--data-sharing", "maybe"}), 2), HasSubstr("maybe"));
  EXPECT_THAT(OutputOf(Troupe({"run", "x.world", "--threads", "0"}), 2), HasSubstr("--threads"));
}

}  // namespace
}  // namespace troupe::test
