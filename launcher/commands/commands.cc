#include "launcher/commands/commands.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "command_line/exit_status.h"
#include "transport/dds/tools/session_monitor.h"

namespace troupe {

int Fail(const Error& error) {
  fmt::print(stderr, "{}\n", error.ToString());
  return ExitStatusOf(error);
}

Status SelectSession(NetworkSettings& network) {
  if (!network.session.empty()) return {};
  using std::chrono::steady_clock;
  SessionMonitor monitor(network);
  const auto deadline = steady_clock::now() + std::chrono::duration<double>(kDiscoverySeconds);
  while (steady_clock::now() < deadline) {
    monitor.WaitForChange(0.1);
    const std::vector<SessionInfo> sessions = monitor.Sessions();
    if (sessions.size() == 1) {
      network.session = sessions.front().session;
      return {};
    }
    if (sessions.empty()) continue;
    std::string names;
    for (const SessionInfo& info : sessions) names += (names.empty() ? "" : ", ") + info.session;
    return Failure("found several sessions (" + names + "), expected the name of one");
  }
  return Failure("found no session");
}

}  // namespace troupe
