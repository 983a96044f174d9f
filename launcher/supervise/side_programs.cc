#include "launcher/supervise/side_programs.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>
#include <vector>

#include "command_line/exit_status.h"
#include "command_line/ros_flags.h"
#include "common/base/random_id.h"

namespace troupe {
namespace {

// s. A program that dies again and again is started ever more rarely, but each time: ROS nodes wait for it.
constexpr double kFirstRestart = 0.1;
constexpr double kLongestRestart = 30.0;
constexpr double kHealthyTime = 60.0;  // after this its delays begin anew

constexpr const char* kServiceBridge = "ros-service-bridge";

constexpr double kBridgeStopSeconds = 5.0;

double SecondsNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Status SupervisedProcess::Start(Host& host, std::vector<std::string> arguments) {
  host_ = &host;
  arguments_ = std::move(arguments);
  return StartProcess();
}

Status SupervisedProcess::StartProcess() {
  Result<std::unique_ptr<Child>> process = host_->Start(settings_.program, arguments_, false);
  if (!process.ok()) return process.error();
  process_ = std::move(process).value();
  started_.reset();
  return Status();
}

std::optional<std::string> SupervisedProcess::Poll(double now) {
  if (due_ && now >= *due_) {
    due_.reset();
    if (const Status status = StartProcess(); !status.ok()) {
      due_ = now + kLongestRestart;
      return status.error().message;
    }
  }
  if (!process_) return std::nullopt;
  if (!started_) started_ = now;
  if (!process_->Poll() || stopped_) return std::nullopt;
  const std::string& host = host_->name();
  const std::string text =
      fmt::format("{} ({}process {}) {}", settings_.shown_name, host.empty() ? "" : "on host " + host + ", ",
                  process_->pid(), process_->end()->ToString());
  if (process_->end()->exit_code == kExitBadInput) return text + "; " + settings_.consequence;
  if (now - *started_ > kHealthyTime) delay_ = 0.0;
  delay_ = std::clamp(2.0 * delay_, kFirstRestart, kLongestRestart);
  due_ = now + delay_;
  return text + "; it is started again";
}

void SupervisedProcess::Stop() {
  stopped_ = true;
  due_.reset();
  if (process_) process_->Signal(SIGTERM);
}

void SupervisedProcess::Kill() {
  stopped_ = true;
  due_.reset();
  if (process_) process_->Kill();
}

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

Status HostParticipants::Start(std::vector<AgentSite>& sites, const RunOptions& options) {
  const std::string name = fmt::format("troupe-ros-participant/{:016x}", MakeRandomId());
  Status first;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const std::string socket = fmt::format("{}/{}", name, i);
    std::vector<std::string> arguments = {"--session=" + options.network.session, "--socket=" + socket};
    for (std::string& argument : RosArguments(options.ros)) arguments.push_back(std::move(argument));
    SupervisedProcess& process = processes_.emplace_back(SupervisedProcess::Settings{
        "ros-participant", "the ROS participant of the robots", "the robots are not in ROS"});
    const Status started = process.Start(*sites[i].host, std::move(arguments));
    if (started.ok()) {
      sites[i].ros_participant = socket;
    } else if (first.ok()) {
      first = started;
    }
  }
  return first;
}

std::vector<std::string> HostParticipants::Poll(double now) {
  std::vector<std::string> lines;
  for (SupervisedProcess& process : processes_) {
    if (std::optional<std::string> line = process.Poll(now)) lines.push_back(*std::move(line));
  }
  return lines;
}

std::optional<double> HostParticipants::NextDue() const {
  std::optional<double> next;
  for (const SupervisedProcess& process : processes_) {
    if (process.NextDue()) next = std::min(next.value_or(*process.NextDue()), *process.NextDue());
  }
  return next;
}

bool HostParticipants::running() const {
  return std::any_of(processes_.begin(), processes_.end(),
                     [](const SupervisedProcess& process) { return process.running(); });
}

void HostParticipants::Stop() {
  for (SupervisedProcess& process : processes_) process.Stop();
}

void HostParticipants::Kill() {
  for (SupervisedProcess& process : processes_) process.Kill();
}

void InProcessBridge::Start(const RunOptions& options) {
  const Status started = bridge_.Start(host_, options);
  if (!started.ok()) {
    fmt::print(stderr, "cannot start the bridge of ROS services: {}\n", started.error().message);
  }
  on_ = bridge_.running();
}

std::vector<int> InProcessBridge::descriptors() const {
  return on_ ? host_.descriptors() : std::vector<int>();
}

int InProcessBridge::WaitMilliseconds() const {
  if (!bridge_.NextDue()) return -1;
  return std::max(0, static_cast<int>(1000.0 * (*bridge_.NextDue() - SecondsNow())) + 1);
}

void InProcessBridge::Process() {
  if (!on_) return;
  const std::optional<std::string> end = bridge_.Poll(SecondsNow());
  PrintOutput();
  if (end) fmt::print(stderr, "{}\n", *end);
}

void InProcessBridge::PrintOutput() {
  for (const std::string& line : host_.ReadOutput()) fmt::print(stderr, "{}\n", line);
}

void InProcessBridge::Stop(SignalWatch& signals) {
  if (!on_) return;
  bridge_.Stop();
  const double end = SecondsNow() + kBridgeStopSeconds;
  while (bridge_.running() && SecondsNow() < end) {
    pollfd waited = {signals.descriptor(), POLLIN, 0};
    poll(&waited, 1, static_cast<int>(1000.0 * (end - SecondsNow())) + 1);
    signals.ReadStopRequest();
    Process();
  }
  bridge_.Kill();
}

Status ViewerProcess::Start(Host& host, const RunOptions& options, const std::string& service_address,
                            const RunKeys& keys) {
  const NetworkSettings& network = options.network;
  const std::vector<std::string> arguments = {"view",
                                              network.session,
                                              "--domain=" + std::to_string(network.domain),
                                              "--interface=" + network.network_interface,
                                              "--service=" + service_address,
                                              "--security=" + keys.ForTools()};
  Result<std::unique_ptr<Child>> process = host.Start("troupe", arguments, false);
  if (!process.ok()) return process.error();
  process_ = std::move(process).value();
  return Status();
}

Status ViewerProcess::Poll() {
  if (!process_ || !process_->Poll() || stopped_) return Status();
  return Failure("the viewer " + process_->end()->ToString() + "; to start another one: troupe view");
}

void ViewerProcess::Stop() {
  stopped_ = true;
  if (process_) process_->Signal(SIGTERM);
}

void ViewerProcess::Kill() {
  stopped_ = true;
  if (process_) process_->Kill();
}

}  // namespace troupe
