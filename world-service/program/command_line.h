// The command line of the program world-service.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "command_line/exit_status.h"
#include "command_line/run_flags.h"
#include "common/run/network_settings.h"
#include "common/run/run_settings.h"
#include "ros/messages/ros_options.h"
#include "transport/protocol/faulty_transport.h"
#include "world-service/observers/recorder/recorder.h"
#include "world-service/service/owner_permissions.h"
#include "world-service/service/run_service.h"
#include "worldfile/load_world.h"

namespace troupe {

struct ServiceCommandLine {
  std::string file;
  LoadOverrides overrides;
  BranchFlags branch;  // of a recording
  RunOverrides run;    // of the settings of the file
  NetworkSettings network;
  OwnerPermissions permissions;
  ServiceOptions service;  // without the settings
  OutputFiles outputs;
  ros::RosOptions ros = ros::OptionsFromEnvironment();
  std::optional<std::uint32_t> threads;
  std::optional<int> report_fd;
  bool resume = false;               // the run of the journal in `outputs`
  std::vector<std::uint16_t> ports;  // UDP, for discovery, by group of agents; those not given: the first free ones
  Faults faults;                     // for tests
};

// An exit status: help, the version or an error has been printed.
std::variant<ServiceCommandLine, int> ParseServiceCommandLine(int argc, const char* const* argv);

}  // namespace troupe
