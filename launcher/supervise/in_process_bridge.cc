#include "launcher/supervise/in_process_bridge.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace troupe {
namespace {

constexpr double kBridgeStopSeconds = 5.0;

double SecondsNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

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

}  // namespace troupe
