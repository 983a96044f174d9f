// Whole runs with and without shared memory between their processes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>

#include "tests/process/output_folder.h"
#include "tests/process/programs.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

std::string HashesOf(const std::vector<std::string>& options) {
  const OutputFolder folder;
  std::vector<std::string> arguments = {"--ticks", "100", "--hash-log", folder.Path("hashes")};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Finished run = Finish(RunPen(arguments));
  EXPECT_EQ(run.exit_status, 0) << run.output;
  EXPECT_EQ(run.output.find("no data sharing"), std::string::npos) << run.output;
  return folder.Read("hashes");
}

bool SharesMemory(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/maps");
  for (std::string line; std::getline(file, line);) {
    if (line.find("troupe-frames") != std::string::npos) return true;
  }
  return false;
}

TEST(DataSharing, GivesTheHashesOfRunsWithoutIt) {
  const std::string expected = HashesOf({"--in-process", "--threads", "1"});
  ASSERT_NE(expected, "");
  EXPECT_EQ(HashesOf({"--in-process", "--threads", "2"}), expected);
  EXPECT_EQ(HashesOf({"--data-sharing", "on"}), expected);
  EXPECT_EQ(HashesOf({"--data-sharing", "off"}), expected);
  EXPECT_EQ(HashesOf({"--data-sharing", "on", "--robots-per-process", "3", "--threads", "2"}), expected);
  EXPECT_EQ(HashesOf({"--security", "on"}), expected);
}

TEST(DataSharing, IsUsedByAllProcessesOfAMachineUnlessItIsOff) {
  for (const bool on : {true, false}) {
    Program run = RunPen({"--speed", "1", "--data-sharing", on ? "on" : "off"});
    run.WaitForLine("4 robots in 4 agent processes, ready");
    const std::vector<pid_t> processes = ChildrenOf(run.pid());
    EXPECT_GE(processes.size(), 5u);
    for (const pid_t process : processes) {
      const std::string command = CommandLineOf(process);
      if (command.find("robot-agent") == std::string::npos && command.find("world-service") == std::string::npos)
        continue;
      EXPECT_EQ(SharesMemory(process), on) << command;
    }
    run.Signal(SIGINT);
    run.Wait();
  }
}

TEST(DataSharing, LeavesNoProcessOfAKilledLauncher) {
  Program run = RunPen({"--speed", "1"});
  run.WaitForLine("4 robots in 4 agent processes, ready");
  const std::vector<pid_t> processes = ChildrenOf(run.pid());
  run.Signal(SIGKILL);
  for (const pid_t process : processes) EXPECT_TRUE(IsGoneSoon(process));
}

TEST(DataSharing, RefusesOtherValues) {
  const Finished run = Finish(Troupe({"run", "x.world", "--data-sharing", "maybe"}));
  EXPECT_EQ(run.exit_status, 2);
  EXPECT_THAT(run.output, HasSubstr("maybe"));
  const Finished threads = Finish(Troupe({"run", "x.world", "--threads", "0"}));
  EXPECT_EQ(threads.exit_status, 2);
  EXPECT_THAT(threads.output, HasSubstr("--threads"));
}

}  // namespace
}  // namespace troupe::test
