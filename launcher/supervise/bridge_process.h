// BridgeProcess: the program ros-service-bridge of a run with ROS 2, on the launcher's host. It is started again when
// it dies; whatever becomes of it, the run goes on.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "launcher/hosts/host.h"
#include "launcher/supervise/run_options.h"

namespace troupe {

// Whether the program is installed beside this one.
bool HasServiceBridge();

// Chooses the programs whose service calls are answered, unless the options do. The error is a choice that needs a
// bridge where it is not installed.
Status ChooseServiceClients(RunOptions& options);

class BridgeProcess {
 public:
  // No effect where the options need no bridge. The host must outlive this. The error is for people.
  Status Start(Host& host, const RunOptions& options);

  // Checks for its end, and starts it again when that is due. `now` in s, of any clock that does not decrease. A line
  // for the user about its end, once.
  std::optional<std::string> Poll(double now);
  // When it is to be started again; nothing: it is not pending.
  std::optional<double> NextDue() const { return due_; }
  bool running() const { return process_ && process_->running(); }
  // Asks it to end, and starts it no more. No effect without a bridge, as below.
  void Stop();
  void Kill();

 private:
  Status StartProcess();

  Host* host_ = nullptr;
  std::vector<std::string> arguments_;
  std::unique_ptr<Child> process_;  // null: none
  std::optional<double> started_;   // s
  std::optional<double> due_;
  double delay_ = 0.0;  // s, of the next restart
  bool stopped_ = false;
};

}  // namespace troupe
