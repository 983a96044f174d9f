#include "launcher/ctl_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "common/base/deterministic_math.h"
#include "common/command_line/exit_status.h"
#include "common/command_line/option_checks.h"
#include "common/dds/control_client.h"
#include "common/dds/session_monitor.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kDiscoverySeconds = 5.0;

struct CtlOptions {
  ControlRequest request;
  std::string session;
  std::uint32_t domain = 42;
  std::string network_interface = "lo";
  std::string service_address;
  double timeout_seconds = 0.0;
  std::vector<double> pose;  // x, y, z in m, heading in degrees
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

const char* Word(EntityKind kind) {
  switch (kind) {
    case EntityKind::kRobot:
      return "robot";
    case EntityKind::kObject:
      return "object";
    case EntityKind::kModel:
      return "model";
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
  return client.Call(options.request, options.timeout_seconds);
}

void Print(const EntityReport& entity) {
  const Pose& X_WE = entity.X_WE;
  fmt::print("{:<6} {:<24} {:<12} {:.3f},{:.3f},{:.3f},{:.2f}\n", Word(entity.kind), entity.name, entity.type, X_WE.x,
             X_WE.y, X_WE.z, RadiansToDegrees(X_WE.heading));
}

void Print(ControlCommand command, const ControlReply& reply) {
  if (command == ControlCommand::kSpawnables) {
    for (const EntityReport& model : reply.entities) fmt::print("{:<24} {}\n", model.name, model.type);
    return;
  }
  for (const EntityReport& entity : reply.entities) Print(entity);
  if (command == ControlCommand::kEntities) return;
  fmt::print("{} tick {} hash {:016x}", Word(reply.state), reply.tick, reply.state_hash);
  if (reply.edition > 0) fmt::print(" edition {}", reply.edition);
  fmt::print("\n");
}

// The service may have another working folder.
std::string AbsolutePath(const std::string& source) {
  const std::size_t end = std::min(source.rfind('#'), source.size());
  const std::string ending = std::filesystem::path(source.substr(0, end)).extension().string();
  if (ending != ".world" && ending != ".inc" && ending != ".json" && ending != ".yaml" && ending != ".yml")
    return source;
  return std::filesystem::absolute(source).lexically_normal().string();
}

int CtlCommand(CtlOptions options) {
  options.request.source = AbsolutePath(options.request.source);
  if (!options.pose.empty()) {
    options.request.pose = {options.pose[0], options.pose[1], options.pose[2], DegreesToRadians(options.pose[3])};
  }
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
    Print(options.request.command, reply.value());
    return kExitDone;
  } catch (const std::exception& failure) {
    fmt::print(stderr, "error: {}\n", failure.what());
    return kExitFailed;
  }
}

// Options of a reset that concerns only a part.
void AddReset(CLI::App* reset, const std::shared_ptr<CtlOptions>& options) {
  const auto add = [&](const char* name, const char* help, std::uint8_t scope) {
    reset->add_flag_callback(
        name,
        [options, scope] {
          std::uint8_t& scopes = options->request.scopes;
          scopes = static_cast<std::uint8_t>((scopes == kResetAll ? 0 : scopes) | scope);
        },
        help);
  };
  add("--time", "Only back to tick 0", kResetTime);
  add("--state", "Only robots and objects back to where they were at first", kResetState);
  add("--spawned", "Only what was spawned goes", kResetSpawned);
}

}  // namespace

void AddCtlCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("ctl", "Pause, play or step a run, or change its world");
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
    action->callback([options, what] { options->request.command = what; });
    return action;
  };
  add("status", "Say where the run is", ControlCommand::kStatus);
  add("pause", "Pause after the tick that is under way", ControlCommand::kPause);
  add("play", "Go on", ControlCommand::kPlay);
  add("step", "Go on from a pause for some ticks, and pause again", ControlCommand::kStep)
      ->add_option("TICKS", options->request.ticks, "How many (default: 1)")
      ->check(WholeNumber(1));
  AddReset(add("reset", "Begin anew: the world as loaded, at tick 0", ControlCommand::kReset), options);
  const auto add_name = [&](CLI::App* action) {
    action->add_option("NAME", options->request.name, "Name of a robot, an object or a model")->required();
  };
  const auto add_pose = [&](CLI::App* action) {
    return action->add_option("--pose", options->pose, "Where: m and degrees")
        ->delimiter(',')
        ->expected(4)
        ->type_name("X,Y,Z,HEADING");
  };
  add("load", "Change the world for that of a file", ControlCommand::kLoadWorld)
      ->add_option("FILE", options->request.source, "A Stage .world file, a JSON scenario or a ROS map .yaml")
      ->required();
  CLI::App* const spawn = add("spawn", "Put a new robot, object or model into the world", ControlCommand::kSpawn);
  spawn
      ->add_option("SOURCE", options->request.source,
                   "A model of the run's world file, a file with one model, or FILE#MODEL")
      ->required();
  spawn->add_option("--name", options->request.name, "Its name (default: after the model)")->type_name("NAME");
  spawn->add_flag("--rename", options->request.rename, "Take another name if this one is in use");
  add_pose(spawn);
  add_name(add("delete", "Take a robot, an object or a model away", ControlCommand::kDelete));
  CLI::App* const set_pose = add("set-pose", "Put a robot, an object or a model elsewhere", ControlCommand::kSetPose);
  add_name(set_pose);
  add_pose(set_pose)->required();
  add("list", "List what is in the world, and where", ControlCommand::kEntities);
  add_name(add("get", "Say where one of these is", ControlCommand::kEntities));
  add("spawnables", "List the models of the run's world file", ControlCommand::kSpawnables);
  command->final_callback([options, &exit_status] { exit_status = CtlCommand(*options); });
}

}  // namespace troupe
