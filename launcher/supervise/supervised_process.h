// SupervisedProcess: a program beside a run, which the run can do without. It is started again when it dies.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "launcher/hosts/host.h"

namespace troupe {

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

}  // namespace troupe
