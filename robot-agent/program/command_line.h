// The command line of the program robot-agent.
//
// The launcher writes this line for each agent; users write it for robots on other hosts. Options that several programs
// have are in command_line/ and ros/flags. docs/running.md and the man page list them.
#pragma once

#include <optional>
#include <variant>

#include "command_line/parse_command_line.h"
#include "common/run/run_settings.h"
#include "robot-agent/agent/agent_host.h"
#include "ros/messages/ros_options.h"
#include "transport/protocol/faulty_transport.h"

namespace troupe {

struct AgentCommandLine {
  NetworkSettings network;
  AgentOptions agent;  // without its id, its gateway and its libraries
  std::vector<std::string> libraries;
  std::optional<bool> ros_on;
  ros::RosOptions ros = ros::OptionsFromEnvironment();
  Faults faults;                   // for tests
  double start_delay_seconds = 0;  // for tests: wait before joining
};

// An exit status: help, the version or an error has been printed.
std::variant<AgentCommandLine, int> ParseAgentCommandLine(int argc, const char* const* argv);

}  // namespace troupe
