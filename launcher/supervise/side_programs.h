// The programs beside a run, which the run can do without: its viewer, and those that connect it to ROS 2.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "launcher/hosts/host.h"
#include "launcher/hosts/host.h"
#include "launcher/process/signal_watch.h"
#include "launcher/supervise/agent_fleet.h"
#include "launcher/supervise/run_keys.h"
#include "launcher/supervise/run_options.h"

namespace troupe {

// A program that is started again when it dies.
class SupervisedProcess {
 public:
  struct Settings {
    std::string program;
    std::string shown_name;   // "the bridge of ROS services"
    std::string consequence;  // of a refusal of its options, which is final: "clients on rmw_fastrtps get no answers"
  };

  explicit SupervisedProcess(Settings settings) : settings_(std::move(settings)) {}

  // The host must outlive this. The error is for people.
  Status Start(Host& host, std::vector<std::string> arguments);

  // Checks for its end, and starts it again when that is due. `now` in s, of any clock that does not decrease. A line
  // for the user about its end, once.
  std::optional<std::string> Poll(double now);
  // When it is to be started again; nothing: it is not pending.
  std::optional<double> NextDue() const { return due_; }
  bool running() const { return process_ && process_->running(); }
  // Asks it to end, and starts it no more. No effect before Start, as below.
  void Stop();
  void Kill();

 private:
  Status StartProcess();

  Settings settings_;
  Host* host_ = nullptr;
  std::vector<std::string> arguments_;
  std::unique_ptr<Child> process_;  // null: none
  std::optional<double> started_;   // s
  std::optional<double> due_;
  double delay_ = 0.0;  // s, of the next restart
  bool stopped_ = false;
};

// Whether the program is installed beside this one.
bool HasServiceBridge();

// Chooses the programs whose service calls are answered, unless the options do. The error is a choice that needs a
// bridge where it is not installed.
Status ChooseServiceClients(RunOptions& options);

// The program ros-service-bridge of a run with ROS 2, on the launcher's host.
class BridgeProcess : public SupervisedProcess {
 public:
  BridgeProcess();

  // No effect where the options need no bridge. The host must outlive this. The error is for people.
  Status Start(Host& host, const RunOptions& options);
};

// The programs ros-participant of a run with ROS 2, one on each host with agents.
class HostParticipants {
 public:
  // Starts them, and tells the sites their sockets; the agents of a site without one have participants of their own.
  // The hosts must outlive this. The error, the first one, is for people.
  Status Start(std::vector<AgentSite>& sites, const RunOptions& options);

  // As those of SupervisedProcess, of all.
  std::vector<std::string> Poll(double now);
  std::optional<double> NextDue() const;
  bool running() const;
  void Stop();
  void Kill();

 private:
  std::deque<SupervisedProcess> processes_;
};

// The ros-service-bridge of a run in one process: a child of that process all the same, because it is on another DDS
// implementation.
class InProcessBridge {
 public:
  // As BridgeProcess::Start. Without a bridge the run is the same.
  void Start(const RunOptions& options);

  // Readable when Process has something to do; empty without a bridge.
  std::vector<int> descriptors() const;
  // The time for which to wait for them, in ms; -1: without end.
  int WaitMilliseconds() const;
  // Prints its lines, and starts it again when it has died.
  void Process();
  // Ends it; kills it if it does not end within seconds. `signals` tells of the ends of children.
  void Stop(SignalWatch& signals);

 private:
  void PrintOutput();

  LocalHost host_;
  BridgeProcess bridge_;
  bool on_ = false;
};

// `troupe view` as a process of its own, on the launcher's host.
class ViewerProcess {
 public:
  // `service_address` is "host:port". The error is for people; without a viewer the run is the same.
  Status Start(Host& host, const RunOptions& options, const std::string& service_address, const RunKeys& keys);

  // Checks for its end. The error, once, is an end that was not asked for.
  Status Poll();
  bool running() const { return process_ && process_->running(); }
  // Asks it to end. No effect without a viewer, as below.
  void Stop();
  void Kill();

 private:
  std::unique_ptr<Child> process_;  // null: none
  bool stopped_ = false;
};

}  // namespace troupe
