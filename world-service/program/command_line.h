// The command line of the program world-service.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "command_line/parse_command_line.h"
#include "common/run/run_settings.h"
#include "transport/protocol/faulty_transport.h"
#include "world-service/program/prepared_run.h"

namespace troupe {

struct ServiceCommandLine : RunSource {
  NetworkSettings network;
  std::optional<std::uint32_t> threads;
  std::optional<int> report_fd;
  std::vector<std::uint16_t> ports;  // UDP, for discovery, by group of agents; those not given: the first free ones
  Faults faults;                     // for tests
};

// An exit status: help, the version or an error has been printed.
std::variant<ServiceCommandLine, int> ParseServiceCommandLine(int argc, const char* const* argv);

}  // namespace troupe
