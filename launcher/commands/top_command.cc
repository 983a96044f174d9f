#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <exception>
#include <memory>

#include "command_line/exit_status.h"
#include "command_line/network_flags.h"
#include "launcher/commands/commands.h"
#include "launcher/commands/session_top.h"
#include "launcher/process/signal_watch.h"
#include "transport/dds/tools/session_monitor.h"
#include "transport/dds/tools/session_observer.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kDiscoveryTime = std::chrono::milliseconds(1500);  // for the discovery of sessions and their status
constexpr double kRefreshSeconds = 0.5;

struct TopOptions {
  NetworkSettings network;  // session empty: all sessions
  bool once = false;        // print one table and end
};

// The sessions of that name; all for an empty name.
std::vector<SessionInfo> SelectSessions(std::vector<SessionInfo> sessions, const std::string& name) {
  if (!name.empty()) std::erase_if(sessions, [&](const SessionInfo& info) { return info.session != name; });
  return sessions;
}

void PrintOnce(SessionMonitor& monitor, const TopOptions& options) {
  for (auto end = Clock::now() + kDiscoveryTime; Clock::now() < end;) monitor.WaitForChange(0.1);
  fmt::print("{}", SessionTable(SelectSessions(monitor.Sessions(), options.network.session)));
}

void PrintUntilStopped(SessionMonitor& monitor, const TopOptions& options, SignalWatch& signals) {
  while (!signals.ReadStopRequest()) {
    fmt::print("\033[H\033[J{}\nCtrl-C ends this.\n",
               SessionTable(SelectSessions(monitor.Sessions(), options.network.session)));
    std::fflush(stdout);
    for (auto next = Clock::now() + std::chrono::duration<double>(kRefreshSeconds); Clock::now() < next;) {
      monitor.WaitForChange(kRefreshSeconds);
    }
  }
}

// Lines of the terminal.
std::size_t TerminalRows() {
  winsize size{};
  constexpr std::size_t kUsual = 40;
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 ? size.ws_row : kUsual;
}

int ShowRobots(const TopOptions& options, SignalWatch& signals) {
  SessionTop top;
  const Result<std::unique_ptr<SessionObserver>> observer = ObserveSession(options.network, top);
  if (!observer.ok()) return Fail(observer.error());
  constexpr std::size_t kFooter = 2;
  while (!signals.ReadStopRequest()) {
    fmt::print("\033[H\033[J{}: {}\nCtrl-C ends this.\n", options.network.session, top.Text(TerminalRows() - kFooter));
    std::fflush(stdout);
    pollfd waited = {signals.descriptor(), POLLIN, 0};
    poll(&waited, 1, static_cast<int>(1000.0 * kRefreshSeconds));
  }
  return kExitDone;
}

int TopCommand(const TopOptions& options) {
  SignalWatch signals;
  try {
    if (!options.once && !options.network.session.empty()) return ShowRobots(options, signals);
    SessionMonitor monitor(options.network);
    if (options.once) {
      PrintOnce(monitor, options);
    } else {
      PrintUntilStopped(monitor, options, signals);
    }
  } catch (const std::exception& exception) {
    return Fail(Failure(exception.what()));
  }
  return kExitDone;
}

}  // namespace

void AddTopCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("top", "Show the running sessions, and the robots for which they wait");
  const auto options = std::make_shared<TopOptions>();
  AddSessionFlag(*command, options->network, "Show the robots of this session (default: all sessions)");
  AddToolNetworkFlags(*command, options->network);
  command->add_flag("--once", options->once, "Print one table and exit");
  command->final_callback([options, &exit_status] { exit_status = TopCommand(*options); });
}

}  // namespace troupe
