#include "launcher/supervise/bridge_process.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "command_line/ros_flags.h"

namespace troupe {
namespace {

constexpr const char* kServiceBridge = "ros-service-bridge";

}  // namespace

bool HasServiceBridge() {
  return FindProgram(kServiceBridge).ok();
}

Status ChooseServiceClients(RunOptions& options) {
  using ros::ServiceClients;
  std::optional<ServiceClients>& clients = options.ros.service_clients;
  options.ros.session = options.network.session;
  const bool installed = HasServiceBridge();
  if (!clients) clients = installed ? ServiceClients::kBoth : ServiceClients::kCyclone;
  if (*clients == ServiceClients::kCyclone || installed) return Status();
  return Error{{},
               fmt::format("--ros-services: found '{}', expected cyclone: {} is not installed beside troupe",
                           ros::ToString(*clients), kServiceBridge)};
}

BridgeProcess::BridgeProcess()
    : SupervisedProcess({kServiceBridge, "the bridge of ROS services", "clients on rmw_fastrtps get no answers"}) {}

Status BridgeProcess::Start(Host& host, const RunOptions& options) {
  if (!ros::UsesBridge(options.ros)) return Status();
  std::vector<std::string> arguments = {"--session=" + options.ros.session};
  for (std::string& argument : RosArguments(options.ros)) arguments.push_back(std::move(argument));
  return SupervisedProcess::Start(host, std::move(arguments));
}

}  // namespace troupe
