// A run with more agents than a group holds: the launcher divides them among the service's participants.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <set>
#include <string>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

constexpr int kRobots = 70;

class AgentGroupsRunTest : public testing::Test {
 protected:
  AgentGroupsRunTest() {
    std::ofstream world(Path("yard.world"));
    world << "define bot position ( size [ 0.4 0.4 0.3 ] )\n";
    for (int i = 0; i < kRobots; ++i) {
      world << "bot( name \"r" << i << "\" pose [ " << i % 10 << " " << i / 10 << " 0 0 ] )\n";
    }
  }

  std::string Path(const std::string& name) const { return folder_.Path(name); }
  Program Run(const std::string& hashes, std::vector<std::string> more) const {
    return Troupe(Words("run % --headless --controller wander --ticks 60 --domain % --hash-log %",
                        {Path("yard.world"), std::to_string(TestDomain()), Path(hashes)}) +
                  more);
  }
  void ExpectHashesOfOneProcess() const {
    OutputOf(Run("whole", {"--in-process"}));
    EXPECT_EQ(folder_.Read("hashes"), folder_.Read("whole"));
  }

  TemporaryFolder folder_;
};

// The value of an option in a command line.
std::string OptionOf(const std::string& command_line, const std::string& option) {
  const std::size_t begin = command_line.find(option + "=");
  if (begin == std::string::npos) return {};
  const std::size_t value = begin + option.size() + 1;
  return command_line.substr(value, command_line.find(' ', value) - value);
}

TEST_F(AgentGroupsRunTest, AgentsOfSeveralGroupsContinueWithAnotherService) {
  Program run = Run("hashes", {"--speed", "20", "--lease", "1", "--session", TestSession("groups")});
  run.WaitForLine("70 robots in 70 agent processes, ready");
  std::set<std::string> services;
  std::set<std::string> participants;
  pid_t service = 0;
  for (const pid_t child : ChildrenOf(run.pid())) {
    const std::string command_line = CommandLineOf(child);
    if (command_line.find("world-service") != std::string::npos) service = child;
    if (command_line.find("robot-agent") == std::string::npos) continue;
    services.insert(OptionOf(command_line, "--service"));
    participants.insert(OptionOf(command_line, "--service-participant"));
  }
  EXPECT_EQ(services.size(), 2u);
  EXPECT_EQ(participants.size(), 2u);
  ASSERT_NE(service, 0);
  ASSERT_EQ(kill(service, SIGKILL), 0);
  run.WaitForLineAfter("the world service has been started again");
  EXPECT_EQ(run.Wait(), 0) << run.output();
  ExpectHashesOfOneProcess();
}

TEST_F(AgentGroupsRunTest, AnAgentThatDiesRejoinsItsGroup) {
  Program run = Run(
      "hashes", {"--speed", "20", "--lease", "1", "--session", TestSession("groups"), "--on-agent-loss", "rebuild"});
  run.WaitForLine("70 robots in 70 agent processes, ready");
  int killed = 0;
  for (const pid_t child : ChildrenOf(run.pid())) {
    if (CommandLineOf(child).find("robot-agent") == std::string::npos) continue;
    if (++killed > 4) break;
    ASSERT_EQ(kill(child, SIGKILL), 0);
  }
  EXPECT_EQ(run.Wait(), 0) << run.output();
  ExpectHashesOfOneProcess();
}

}  // namespace
}  // namespace troupe::test
