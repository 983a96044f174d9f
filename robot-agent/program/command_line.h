// The command line of the program robot-agent.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "common/command_line/exit_status.h"
#include "common/command_line/ros_flags.h"
#include "common/protocol/faulty_transport.h"
#include "robot-agent/agent/agent_host.h"

namespace troupe {

struct CommandLine {
  std::string session;
  AgentOptions agent;  // without its id
  std::uint32_t domain = 42;
  std::string service_address;    // "host" or "host:port"; empty: on this machine
  std::string network_interface;  // a name, or "auto"
  std::string network;            // profile of common/dds/domain_config.h; empty: by the interface
  double lease_seconds = 2.0;
  RosFlags ros;
  Faults faults;                   // for tests
  double start_delay_seconds = 0;  // for tests: wait before joining
};

// The options, or an exit status after help, version or an error was printed.
std::variant<CommandLine, int> ParseCommandLine(int argc, const char* const* argv);

}  // namespace troupe
