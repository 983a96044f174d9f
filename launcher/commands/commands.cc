#include "launcher/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "command_line/exit_status.h"
#include "transport/dds/tools/session_monitor.h"
#include "transport/security/session_keys.h"

namespace troupe {

int Fail(const Error& error) {
  fmt::print(stderr, "{}\n", error.ToString());
  return ExitStatusOf(error);
}

Status SelectSession(NetworkSettings& network) {
  if (!network.session.empty()) return {};
  using std::chrono::steady_clock;
  const auto begin = steady_clock::now();
  SessionMonitor monitor(network);
  SessionChoice choice;
  for (;;) {
    const std::chrono::duration<double> passed = steady_clock::now() - begin;
    std::set<std::string> found;
    for (const SessionInfo& info : monitor.Sessions()) found.insert(info.session);
    // The user's own runs on this host are known before they are discovered.
    std::set<std::string> published;
    for (const SessionKeys& known : FindSessionKeys(network.domain)) published.insert(known.session);
    choice.Update(found, std::includes(found.begin(), found.end(), published.begin(), published.end()), passed.count());
    if (choice.is_made() || passed.count() > kDiscoverySeconds) break;
    monitor.WaitForChange(0.02);
  }
  if (choice.sessions().empty()) return Failure("found no session");
  if (choice.sessions().size() > 1) {
    return Failure(
        fmt::format("found several sessions ({}), expected the name of one", fmt::join(choice.sessions(), ", ")));
  }
  network.session = *choice.sessions().begin();
  return {};
}

void SessionChoice::Update(const std::set<std::string>& found, bool all_known, double now) {
  if (found != sessions_) changed_at_ = now;
  sessions_ = found;
  if (sessions_.empty()) return;
  // Another run answers about as soon as the first one did.
  const double quiet = all_known ? std::clamp(changed_at_, kShortestQuiet, kLongestQuiet) : kLongestQuiet;
  is_made_ = sessions_.size() > 1 || now - changed_at_ >= quiet;
}

}  // namespace troupe
