#include "launcher/supervise/bridge_process.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <utility>

#include "common/command_line/exit_status.h"
#include "common/command_line/ros_flags.h"

namespace troupe {
namespace {

constexpr const char* kServiceBridge = "ros-service-bridge";

// s. A bridge that dies again and again is started ever more rarely, but each time: ROS clients wait for it.
constexpr double kFirstBridgeDelay = 0.1;
constexpr double kLongestBridgeDelay = 30.0;
constexpr double kHealthyBridgeTime = 60.0;  // after this its delays begin anew

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

Status BridgeProcess::Start(Host& host, const RunOptions& options) {
  if (!ros::UsesBridge(options.ros)) return Status();
  host_ = &host;
  arguments_ = {"--session=" + options.ros.session};
  for (std::string& argument : RosArguments(options.ros)) arguments_.push_back(std::move(argument));
  return StartProcess();
}

Status BridgeProcess::StartProcess() {
  Result<std::unique_ptr<Child>> process = host_->Start(kServiceBridge, arguments_, false);
  if (!process.ok()) return process.error();
  process_ = std::move(process).value();
  started_.reset();
  return Status();
}

std::optional<std::string> BridgeProcess::Poll(double now) {
  if (due_ && now >= *due_) {
    due_.reset();
    if (const Status status = StartProcess(); !status.ok()) return status.error().message;
  }
  if (!process_) return std::nullopt;
  if (!started_) started_ = now;
  if (!process_->Poll() || stopped_) return std::nullopt;
  const std::string text =
      fmt::format("the bridge of ROS services (process {}) {}", process_->pid(), process_->end()->ToString());
  if (process_->end()->exit_code == kExitBadInput) return text + "; clients on rmw_fastrtps get no answers";
  if (now - *started_ > kHealthyBridgeTime) delay_ = 0.0;
  delay_ = std::clamp(2.0 * delay_, kFirstBridgeDelay, kLongestBridgeDelay);
  due_ = now + delay_;
  return text + "; it is started again";
}

void BridgeProcess::Stop() {
  stopped_ = true;
  due_.reset();
  if (process_) process_->Signal(SIGTERM);
}

void BridgeProcess::Kill() {
  stopped_ = true;
  due_.reset();
  if (process_) process_->Kill();
}

}  // namespace troupe
