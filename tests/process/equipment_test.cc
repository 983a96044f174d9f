// Robots with every kind of sensor and actuator, whose controllers let each bit of each reading decide their motion:
// the same files in every kind of run, whatever dies.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

struct Logs {
  std::string hashes;
  std::string scans;
  bool operator==(const Logs&) const = default;
};

class EquipmentTest : public testing::Test {
 protected:
  EquipmentTest() {
    std::ofstream(Path("equipment.json"))
        << R"({"world": ")" << WorldPath("equipment.world") << R"(", "seed": 8, "robots": [)" << Robot("r0") << ", "
        << Robot("r1") << ", " << Robot("r2") << "]}";
  }
  std::string Path(const std::string& name) const { return folder_.Path(name); }

  Program Start(const std::vector<std::string>& options) const {
    return Troupe(AndFiles(
        Words("run % --domain % --ticks 300 --headless", {Path("equipment.json"), std::to_string(TestDomain())}) +
        options));
  }
  Logs LogsOf(Program program) const {
    OutputOf(std::move(program));
    return {folder_.Read("hash-log"), folder_.Read("scans")};
  }
  Logs LogsOfRun(const std::vector<std::string>& options) const { return LogsOf(Start(options)); }
  Logs LogsOfReplay(const std::vector<std::string>& options) const {
    std::vector<std::string> arguments = {"replay", Path("run.mcap")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return LogsOf(Troupe(AndFiles(std::move(arguments))));
  }

 private:
  static std::string Robot(const std::string& name) {
    return R"({"name": ")" + name + R"(", "controller": ")" FEELING_LIBRARY R"("})";
  }
  std::vector<std::string> AndFiles(std::vector<std::string> arguments) const {
    for (const char* name : {"hash-log", "scans"}) {
      arguments.push_back(std::string("--") + name);
      arguments.push_back(Path(name));
    }
    return arguments;
  }

  TemporaryFolder folder_;
};

TEST_F(EquipmentTest, GivesTheSameFilesInEveryKindOfRun) {
  const Logs expected = LogsOfRun({"--in-process", "--record", Path("run.mcap")});
  for (const char* kind : {"\"ranges\"", "\"fiducials\":[{", "\"pressed_by\":[\"", "\"contacts\":[{", "\"blobs\":[{",
                           "\"received\":[{", "\"turn\"", "\"broken_by\":[\""}) {
    EXPECT_THAT(expected.scans, HasSubstr(kind)) << "the run is too poor for a test";
  }
  EXPECT_TRUE(LogsOfReplay({"--verify", "--controllers"}) == expected);
  EXPECT_TRUE(LogsOfRun({"--in-process", "--threads", "2"}) == expected);
  EXPECT_TRUE(LogsOfRun({}) == expected) << "a process for each robot";
  EXPECT_TRUE(LogsOfRun({"--robots-per-process", "2", "--data-sharing", "off"}) == expected);
  EXPECT_TRUE(LogsOfRun({"--faults", "loss=0.02,duplicate=0.05,reorder=0.05,delay=0.1:0.002,seed=3"}) == expected);
  EXPECT_TRUE(LogsOfRun({"--in-process", "--seed", "4"}).hashes != expected.hashes);
}

TEST_F(EquipmentTest, GivesTheSameFilesWhateverDies) {
  const Logs expected = LogsOfRun({"--in-process"});
  Program run = Start({"--on-agent-loss", "rebuild", "--lease", "1", "--speed", "10", "--record", Path("run.mcap")});
  run.WaitForLine("ready");
  const auto kill_child = [&run](const std::string& part) {
    for (const pid_t child : ChildrenOf(run.pid())) {
      if (CommandLineOf(child).find(part) == std::string::npos) continue;
      ASSERT_EQ(kill(child, SIGKILL), 0);
      return;
    }
    FAIL() << "no process with " << part;
  };
  kill_child("--robot=r1");
  run.WaitForLineAfter("restart ");
  kill_child("world-service");
  run.WaitForLineAfter("the world service has been started again");
  kill_child("--robot=r2");
  run.WaitForLineAfter("restart ");
  // The log of scans is a log of the sent readings, of which those of a killed process are missing.
  EXPECT_EQ(LogsOf(std::move(run)).hashes, expected.hashes);
  EXPECT_TRUE(LogsOfReplay({"--verify", "--controllers"}) == expected);
}

}  // namespace
}  // namespace troupe::test
