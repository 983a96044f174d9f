// One world gives the same files, byte for byte, in every kind of run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

constexpr int kTicksOfRun = 300;
constexpr int kRobotsOfPen = 4;

std::ptrdiff_t CountLines(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

struct Files {
  std::string hashes, poses, scans, record;
  nlohmann::json summary;
};

Files RunWith(std::vector<std::string> arguments) {
  TemporaryFolder folder;
  for (const char* name : {"hash-log", "poses", "scans", "record", "summary"}) {
    arguments.push_back(std::string("--") + name);
    arguments.push_back(folder.Path(name));
  }
  for (const char* word : {"--speed", "max", "--ticks"}) arguments.push_back(word);
  arguments.push_back(std::to_string(kTicksOfRun));
  OutputOf(RunPen(arguments));
  EXPECT_EQ(folder.size(), 5u) << "only the five files that were asked for are left";
  return {folder.Read("hash-log"), folder.Read("poses"), folder.Read("scans"), folder.Read("record"),
          nlohmann::json::parse(folder.Read("summary"), nullptr, false)};
}

// A process for each robot.
const Files& Reference() {
  static const Files files = RunWith({});
  return files;
}

void ExpectSame(const std::vector<std::string>& arguments) {
  Files files = RunWith(arguments);
  EXPECT_EQ(files.hashes, Reference().hashes);
  EXPECT_TRUE(files.poses == Reference().poses);
  EXPECT_TRUE(files.scans == Reference().scans);
  EXPECT_TRUE(files.record == Reference().record);
  for (const char* key : {"ticks", "sim_seconds", "robots", "stalls", "state_hash"}) {
    EXPECT_EQ(files.summary[key], Reference().summary[key]) << key;
  }
}

TEST(SameResult, InASecondRun) {
  ExpectSame({});
}
TEST(SameResult, InOneProcess) {
  ExpectSame({"--in-process"});
}
TEST(SameResult, WithTwoRobotsInAProcess) {
  ExpectSame({"--robots-per-process", "2"});
}
TEST(SameResult, WithThreeRobotsInAProcess) {
  ExpectSame({"--robots-per-process", "3"});
}
TEST(SameResult, WithAgentsStartedLateInAnotherOrder) {
  ExpectSame({"--shuffle-start", "7"});
}
TEST(SameResult, OnALossyNetwork) {
  ExpectSame({"--faults", "loss=0.02,duplicate=0.05,reorder=0.05,delay=0.1:0.002,seed=3"});
}
TEST(SameResult, OnALossyNetworkInOneProcess) {
  ExpectSame({"--in-process", "--faults", "loss=0.02,duplicate=0.05,reorder=0.05,delay=0.1:0.002,seed=3"});
}

TEST(SameResult, DependsOnTheSeed) {
  EXPECT_NE(RunWith({"--in-process", "--seed", "9"}).hashes, Reference().hashes);
}

TEST(OutputFiles, HaveTheFormatsOfTheManual) {
  const Files& files = Reference();
  // The loaded world is tick 0.
  EXPECT_EQ(CountLines(files.hashes), kTicksOfRun + 1);
  EXPECT_THAT(files.hashes.substr(0, files.hashes.find('\n')), testing::MatchesRegex("0 [0-9a-f]+"));
  EXPECT_EQ(CountLines(files.poses), 1 + (kTicksOfRun + 1) * kRobotsOfPen);
  EXPECT_THAT(files.poses, testing::StartsWith("tick,robot,x,y,z,heading,stalled\n0,r0,"));

  std::istringstream scans(files.scans);
  std::ptrdiff_t count = 0;
  for (std::string line; std::getline(scans, line); ++count) {
    nlohmann::json scan = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(scan["tick"].is_number_unsigned() && scan["robot"].is_string() && scan["sensor"].is_string() &&
                scan["ranges"].is_array() && !scan["ranges"].empty())
        << line;
  }
  // Three sonars and a scanner for each robot. The last state has no readings, because no agent answers it.
  EXPECT_EQ(count, kTicksOfRun * kRobotsOfPen * 4);

  std::istringstream record(files.record);
  count = 0;
  for (std::string line; std::getline(record, line); ++count) {
    ASSERT_TRUE(nlohmann::json::parse(line, nullptr, false).is_object()) << line;
  }
  EXPECT_EQ(count, 1 + kTicksOfRun + 1);
  EXPECT_EQ(files.summary["processes"], 1 + kRobotsOfPen);
  EXPECT_GT(files.summary["stalls"], 0) << "the world has too few contacts for a test";
  EXPECT_GT(files.summary["agent_peak_memory_mib"], 0.0);
}

// The scenarios with grippers give the same hash at each tick, over DDS with a process for each robot and in one
// process, and end with a recorded hash: a run begins with a state of its own, which the library's hashes
// do not check.

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
