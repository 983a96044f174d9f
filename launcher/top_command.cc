#include "launcher/top_command.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <exception>

#include "common/command_line/exit_status.h"
#include "common/dds/session_monitor.h"
#include "launcher/session_table.h"
#include "launcher/signal_watch.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kDiscoveryTime =
    std::chrono::milliseconds(1500);  // for the sessions to be found and to say how they are
constexpr double kRefreshSeconds = 0.5;

std::vector<SessionInfo> Chosen(std::vector<SessionInfo> sessions, const std::string& name) {
  if (!name.empty()) std::erase_if(sessions, [&](const SessionInfo& info) { return info.session != name; });
  return sessions;
}

void PrintOnce(SessionMonitor& monitor, const TopOptions& options) {
  for (auto end = Clock::now() + kDiscoveryTime; Clock::now() < end;) monitor.WaitForChange(0.1);
  fmt::print("{}", SessionTable(Chosen(monitor.Sessions(), options.session)));
}

void PrintUntilStopped(SessionMonitor& monitor, const TopOptions& options, SignalWatch& signals) {
  while (!signals.TakeStopRequest()) {
    fmt::print("\033[H\033[J{}\nCtrl-C ends this.\n", SessionTable(Chosen(monitor.Sessions(), options.session)));
    std::fflush(stdout);
    for (auto next = Clock::now() + std::chrono::duration<double>(kRefreshSeconds); Clock::now() < next;) {
      monitor.WaitForChange(kRefreshSeconds);
    }
  }
}

}  // namespace

int TopCommand(const TopOptions& options) {
  SignalWatch signals;
  try {
    SessionMonitor monitor(options.domain, options.network_interface, options.service_address);
    if (options.once) {
      PrintOnce(monitor, options);
    } else {
      PrintUntilStopped(monitor, options, signals);
    }
  } catch (const std::exception& failure) {
    fmt::print(stderr, "error: {}\n", failure.what());
    return kExitFailed;
  }
  return kExitDone;
}

}  // namespace troupe
