// The command line of the program world-service.
//
// Options that `troupe run` has as well are added by the functions of command_line/run_flags.h, so that both programs
// have the same names, checks and texts; only what a service alone needs (ports, the journal's files, the report
// descriptor) is defined here. Options of the group "" are for the launcher, and no part of the user's interface.
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
