#include "launcher/ctl_command.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>

#include "common/command_line/option_checks.h"
#include "common/command_line/parse_command_line.h"
#include "common/dds/control_client.h"
#include "common/dds/session_monitor.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kDiscoverySeconds = 5.0;

struct CtlOptions {
  ControlCommand command = ControlCommand::kStatus;
  std::uint64_t ticks = 1;
  std::string session;
  std::uint32_t domain = 42;
  std::string network_interface = "lo";
  std::string service_address;
  double timeout_seconds = 0.0;
};

const char* Word(RunState state) {
  switch (state) {
    case RunState::kStarting:
      return "starting";
    case RunState::kPlaying:
      return "playing";
    case RunState::kPaused:
      return "paused";
    case RunState::kOver:
      return "over";
  }
  return "";
}

// The only session there is.
Result<std::string> FindSession(const CtlOptions& options) {
  SessionMonitor monitor(options.domain, options.network_interface, options.service_address);
  const auto deadline = Clock::now() + std::chrono::duration<double>(kDiscoverySeconds);
  while (Clock::now() < deadline) {
    monitor.WaitForChange(0.1);
    const std::vector<SessionInfo> sessions = monitor.Sessions();
    if (sessions.size() == 1) return sessions.front().session;
    if (sessions.empty()) continue;
    std::string names;
    for (const SessionInfo& info : sessions) names += (names.empty() ? "" : ", ") + info.session;
    return Error{{}, "found several sessions (" + names + "), expected --session NAME"};
  }
  return Error{{}, "found no session"};
}

Result<ControlReply> Ask(CtlOptions options) {
  if (options.session.empty()) {
    Result<std::string> session = FindSession(options);
    if (!session.ok()) return session.error();
    options.session = session.value();
  }
  ControlClient client(options.domain, options.session, options.network_interface, options.service_address);
  if (Status missing = client.WaitForService(kDiscoverySeconds)) return *missing;
  return client.Call(options.command, options.ticks, options.timeout_seconds);
}

int CtlCommand(const CtlOptions& options) {
  try {
    const Result<ControlReply> reply = Ask(options);
    if (!reply.ok()) {
      fmt::print(stderr, "{}\n", reply.error().ToString());
      return kExitFailed;
    }
    if (!reply.value().done) {
      fmt::print(stderr, "error: {}\n", reply.value().problem);
      return kExitFailed;
    }
    fmt::print("{} tick {} hash {:016x}\n", Word(reply.value().state), reply.value().tick, reply.value().state_hash);
    return kExitDone;
  } catch (const std::exception& failure) {
    fmt::print(stderr, "error: {}\n", failure.what());
    return kExitFailed;
  }
}

}  // namespace

void AddCtlCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("ctl", "Pause, play or step a run");
  auto options = std::make_shared<CtlOptions>();
  command->require_subcommand(1);
  command->add_option("--session", options->session, "The run's session (default: the only one there is)")
      ->check(SessionName())
      ->type_name("NAME");
  command->add_option("--domain", options->domain, "DDS domain of the simulation (default: 42)")
      ->check(DdsDomain())
      ->type_name("D");
  command->add_option("--interface", options->network_interface, "Network interface, or auto (default: lo)")
      ->type_name("NAME");
  command->add_option("--service", options->service_address, "Where a service is that multicast does not reach")
      ->type_name("HOST[:PORT]");
  command->add_option("--timeout", options->timeout_seconds, "Seconds to wait for the answer; 0: for ever (default)")
      ->check(NumberFromZero())
      ->type_name("SECONDS");
  const auto add = [&](const char* name, const char* help, ControlCommand what) {
    CLI::App* action = command->add_subcommand(name, help)->fallthrough();
    action->callback([options, what] { options->command = what; });
    return action;
  };
  add("status", "Say where the run is", ControlCommand::kStatus);
  add("pause", "Pause after the tick that is under way", ControlCommand::kPause);
  add("play", "Go on", ControlCommand::kPlay);
  add("step", "Go on from a pause for some ticks, and pause again", ControlCommand::kStep)
      ->add_option("TICKS", options->ticks, "How many (default: 1)")
      ->check(WholeNumber(1));
  command->final_callback([options, &exit_status] { exit_status = CtlCommand(*options); });
}

}  // namespace troupe
