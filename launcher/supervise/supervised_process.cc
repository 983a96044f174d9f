#include "launcher/supervise/supervised_process.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <utility>

#include "command_line/exit_status.h"

namespace troupe {
namespace {

// s. A program that dies again and again is started ever more rarely, but each time: ROS nodes wait for it.
constexpr double kFirstDelay = 0.1;
constexpr double kLongestDelay = 30.0;
constexpr double kHealthyTime = 60.0;  // after this its delays begin anew

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
      due_ = now + kLongestDelay;
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
  delay_ = std::clamp(2.0 * delay_, kFirstDelay, kLongestDelay);
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

}  // namespace troupe
