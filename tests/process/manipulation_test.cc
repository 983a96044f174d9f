// The scenarios with grippers give the same hash at each tick, over DDS with a process for each robot and in one
// process, and end with a recorded hash: a run begins with a state of its own, which the library's hashes
// do not check.
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

std::string HashesOfScenario(const std::string& scenario, const std::string& ticks, std::vector<std::string> more) {
  TemporaryFolder folder;
  OutputOf(Troupe(Words("run % --domain % --ticks % --speed max --headless --hash-log %",
                        {WorldPath("../../../worlds/scenarios/" + scenario + ".json"), std::to_string(TestDomain()),
                         ticks, folder.Path("hashes")}) +
                  more));
  return folder.Read("hashes");
}

// `last`: the hash at tick `ticks`.
void ExpectSameHashes(const std::string& scenario, const std::string& ticks, const std::string& last) {
  const std::string in_process = HashesOfScenario(scenario, ticks, {"--in-process"});
  EXPECT_TRUE(in_process.ends_with("\n" + ticks + " " + last + "\n")) << in_process.substr(in_process.size() / 2);
  EXPECT_TRUE(HashesOfScenario(scenario, ticks, {}) == in_process);
}

TEST(ManipulationOverDds, StackingIsTheSame) {
  ExpectSameHashes("stacking", "1000", "114874baa4473720");
}
TEST(ManipulationOverDds, MarinaIsTheSame) {
  ExpectSameHashes("marina", "700", "b5da5412597f448d");
}
TEST(ManipulationOverDds, LabIsTheSame) {
  ExpectSameHashes("lab", "450", "8d1da5bfc7d57d2b");
}
// Ten robots, until the beam has been handed over and set down.
TEST(ManipulationOverDds, RelayIsTheSame) {
  ExpectSameHashes("relay", "600", "69906419cd8f68ef");
}

// The new agent knows only the state of the world, which is sufficient.
TEST(ManipulationOverDds, AnAgentKilledWithAPayloadAndRestartedReachesTheSameState) {
  TemporaryFolder folder;
  Program run = Troupe({"run", WorldPath("../../../worlds/scenarios/stage_stacking.json"), "--domain",
                        std::to_string(TestDomain()), "--speed", "10", "--lease", "0.5", "--on-agent-loss", "pause",
                        "--restart-agents", "0", "--headless", "--hash-log", folder.Path("hashes")});
  run.WaitForLine("r holds box");
  for (pid_t child : ChildrenOf(run.pid())) {
    if (CommandLineOf(child).find("--robot=r") != std::string::npos) kill(child, SIGKILL);
  }
  Program agent({"/bin/sh", "-c", "exec " + run.WaitForLineAfter("to start it again:")});
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_EQ(agent.Wait(), 0) << agent.output();
  EXPECT_TRUE(folder.Read("hashes") == HashesOfScenario("stage_stacking", "210", {"--in-process"}));
}

}  // namespace
}  // namespace troupe::test
