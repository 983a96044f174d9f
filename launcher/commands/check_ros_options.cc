#include "launcher/commands/check_ros_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "ros/messages/names.h"
#include "ros/messages/ros_security.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

// Of the world and of the first robot of each process.
std::vector<std::string> EnclavesOf(const RunOptions& options, const LoadedWorld& loaded) {
  std::vector<std::string> enclaves = {ros::kWorldEnclave};
  if (!options.hosts.empty() || options.in_process) return enclaves;
  const std::vector<std::string> robots = ros::RobotNames(loaded.world);
  const std::uint32_t packing = options.run.robots_per_process.value_or(loaded.settings.robots_per_process);
  for (std::size_t i = 0; i < robots.size(); i += std::max(1U, packing)) enclaves.push_back("/" + robots[i]);
  return enclaves;
}

}  // namespace

Status CheckRosOptions(const RunOptions& options) {
  const ros::RosSecurity& security = options.ros.network.security;
  const ros::EnvironmentFaults& faults = options.ros.faults;
  const std::optional<ros::ServiceClients>& clients = options.ros.network.service_clients;
  if (clients && *clients != ros::ServiceClients::kCyclone && !ros::HasFastDds()) {
    return Error{{},
                 fmt::format("--ros-services: found '{}', expected cyclone: Troupe was built without Fast DDS",
                             ros::ToString(*clients))};
  }
  const bool is_open = security.fault.empty() && security.strategy == ros::SecurityStrategy::kOff;
  if (is_open && faults.domain.empty() && faults.distribution.empty() && faults.discovery.empty()) return Status();
  const Result<LoadedWorld> loaded = LoadWorld(options.file, options.load);
  if (!loaded.ok() || !options.run.ros.value_or(loaded.value().settings.ros)) return Status();
  for (const std::string& fault : {faults.domain, faults.distribution}) {
    if (!fault.empty()) return Error{{}, fault};
  }
  if (!faults.discovery.empty()) fmt::print(stderr, "warning: {}\n", faults.discovery);
  if (is_open) return Status();
  for (const std::string& name : EnclavesOf(options, loaded.value())) {
    const Result<ros::Enclave> enclave = ros::FindEnclave(security, name);
    if (!enclave.ok()) return enclave.error();
    // Processes of their own print it themselves.
    if (options.in_process && !enclave.value().warning.empty()) fmt::print(stderr, "{}\n", enclave.value().warning);
  }
  return Status();
}

}  // namespace troupe
