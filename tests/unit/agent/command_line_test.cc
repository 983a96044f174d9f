#include "robot-agent/program/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace troupe {
namespace {

using ::testing::ElementsAre;

std::variant<AgentCommandLine, int> Parse(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "robot-agent");
  return ParseAgentCommandLine(static_cast<int>(arguments.size()), arguments.data());
}

AgentCommandLine ParseGood(std::vector<const char*> arguments) {
  const auto parsed = Parse(std::move(arguments));
  EXPECT_TRUE(std::holds_alternative<AgentCommandLine>(parsed));
  return std::holds_alternative<AgentCommandLine>(parsed) ? std::get<AgentCommandLine>(parsed) : AgentCommandLine{};
}

TEST(AgentCommandLineTest, ReadsEveryOption) {
  const AgentCommandLine line = ParseGood(
      {"--session", "lab",           "--robot",       "r0",       "--robot",           "r1",  "--domain", "7",
       "--service", "10.0.0.1:7410", "--interface",   "10.0.0.5", "--lease",           "3.5", "--scans",  "scans.jsonl",
       "--faults",  "loss=0.25",     "--start-delay", "0.5",      "--session-timeout", "9"});
  EXPECT_EQ(line.network.session, "lab");
  EXPECT_THAT(line.agent.robots, ElementsAre("r0", "r1"));
  EXPECT_EQ(line.network.domain, 7u);
  EXPECT_EQ(line.network.service_address, "10.0.0.1:7410");
  EXPECT_EQ(line.network.network_interface, "10.0.0.5");
  EXPECT_EQ(line.network.lease_seconds, 3.5);
  EXPECT_EQ(line.agent.scan_log, "scans.jsonl");
  EXPECT_EQ(line.faults.loss, 0.25);
  EXPECT_EQ(line.start_delay_seconds, 0.5);
  EXPECT_EQ(line.agent.session_timeout_seconds, 9.0);
}

TEST(AgentCommandLineTest, TheInterfaceFollowsFromWhereTheServiceIs) {
  EXPECT_EQ(ParseGood({"--session=s", "--robot=r"}).network.network_interface, "lo");
  EXPECT_EQ(ParseGood({"--session=s", "--robot=r", "--service=there"}).network.network_interface, "auto");
}

TEST(AgentCommandLineTest, BadUsageIsExitStatusTwo) {
  const std::vector<std::vector<const char*>> table = {
      {},
      {"--robot=r"},
      {"--session=s"},
      {"--session=", "--robot=r"},
      {"--session=*", "--robot=r"},
      {"--session=s", "--robot="},
      {"--session=s", "--robot"},
      {"--session=s", "--robot=r", "another"},
      {"--session=s", "--robot=r", "--domain=231"},
      {"--session=s", "--robot=r", "--domain=-1"},
      {"--session=s", "--robot=r", "--lease=0"},
      {"--session=s", "--robot=r", "--lease=nan"},
      {"--session=s", "--robot=r", "--start-delay=-1"},
      {"--session=s", "--robot=r", "--session-timeout=soon"},
      {"--session=s", "--robot=r", "--faults=luck"},
      {"--session=s", "--robot=r", "--wings"},
  };
  for (const std::vector<const char*>& arguments : table) {
    const auto parsed = Parse(arguments);
    ASSERT_TRUE(std::holds_alternative<int>(parsed));
    EXPECT_EQ(std::get<int>(parsed), kExitBadInput);
  }
}

TEST(AgentCommandLineTest, HelpAndVersionAreNoFailure) {
  EXPECT_EQ(std::get<int>(Parse({"--help"})), kExitDone);
  EXPECT_EQ(std::get<int>(Parse({"--version"})), kExitDone);
}

}  // namespace
}  // namespace troupe
