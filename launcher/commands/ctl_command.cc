#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "common/base/print.h"
#include "launcher/commands/commands.h"
#include "transport/dds/tools/control_client.h"
#include "transport/protocol/message_texts.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

struct CtlOptions {
  NetworkSettings network;  // session empty: the only one
  control::Request request;
  double timeout_seconds = 0.0;  // 0: no limit
  std::string pose;              // text for ParsePoseText; empty: none
  bool lists_agents = false;     // of the entities
};

// The pose of the command line. Without a height an entity keeps the one that it has.
Status SetPoseOfRequest(const CtlOptions& options, ControlClient& client, control::Request& request) {
  if (options.pose.empty()) return Status();
  const Result<PoseText> pose = ParsePoseText(options.pose);
  if (!pose.ok()) return pose.error();
  const Pose& X_WE = pose.value().X_WE;
  if (auto* const spawn = std::get_if<control::Spawn>(&request)) spawn->pose = X_WE;
  if (auto* const restore = std::get_if<control::Restore>(&request)) restore->pose = X_WE;
  auto* const move = std::get_if<control::SetPose>(&request);
  if (move == nullptr) return Status();
  move->pose = X_WE;
  if (pose.value().has_height) return Status();
  const Result<ControlReply> reply = client.Call(control::Entities{.name = move->name}, options.timeout_seconds);
  if (!reply.ok()) return reply.error();
  if (!reply.value().done) return Failure(reply.value().problem);
  if (reply.value().entities.size() == 1) move->pose.z = reply.value().entities.front().X_WE.z;
  return Status();
}

// One request, one reply: the program keeps no connection, so that each call is the same in a script.
Result<ControlReply> SendRequest(const CtlOptions& options) {
  NetworkSettings network = options.network;
  if (const Status problem = SelectSession(network); !problem.ok()) return problem.error();
  ControlClient client(network);
  if (Status missing = client.WaitForService(kDiscoverySeconds); !missing.ok()) return missing.error();
  control::Request request = options.request;
  if (Status failure = SetPoseOfRequest(options, client, request); !failure.ok()) return failure.error();
  return client.Call(request, options.timeout_seconds);
}

void Print(const EntityReport& entity) {
  const Pose& X_WE = entity.X_WE;
  PrintPlain(stdout, "{:<6} {:<24} {:<12} {:.3f},{:.3f},{:.3f},{:.2f}\n", NameOf(entity.kind), entity.name, entity.type,
             X_WE.x, X_WE.y, X_WE.z, RadiansToDegrees(X_WE.heading));
}

void PrintSignals(const EntityReport& entity) {
  std::istringstream lines(entity.signals);
  for (std::string line; std::getline(lines, line);) PrintPlain(stdout, "{}\n", line);
}

// A robot without an agent has only its name.
void PrintAgents(const ControlReply& reply) {
  PrintPlain(stdout, "{:<20} {:<8} {:<20} {:>8} {:>10} {:>10}\n", "ROBOT", "AGENT", "HOST", "PID", "ANSWER MS",
             "TIMES LAST");
  for (const EntityReport& entity : reply.entities) {
    if (entity.kind != EntityKind::kRobot) continue;
    if (!entity.agent) {
      PrintPlain(stdout, "{:<20} {:<8}\n", entity.name, "none");
      continue;
    }
    const AgentReport& agent = *entity.agent;
    PrintPlain(stdout, "{:<20} {:<8} {:<20} {:>8} {:>10.2f} {:>10}\n", entity.name, agent.present ? "present" : "lost",
               agent.host, agent.pid, 1e3 * agent.answer_seconds, agent.times_last);
  }
}

// The last line has the state after the request, in a form for scripts: words in fixed order, the hash in hexadecimal.
void Print(const control::Request& request, const ControlReply& reply) {
  if (control::Is<control::Spawnables>(request)) {
    for (const EntityReport& model : reply.entities) PrintPlain(stdout, "{:<24} {}\n", model.name, model.type);
    return;
  }
  for (const EntityReport& entity : reply.entities) Print(entity);
  if (control::Is<control::Entities>(request)) {
    for (const EntityReport& entity : reply.entities) PrintSignals(entity);
    return;
  }
  PrintPlain(stdout, "{} tick {} hash {:016x}", NameOf(reply.state), reply.tick, reply.state_hash);
  if (reply.edition > 0) PrintPlain(stdout, " edition {}", reply.edition);
  if (reply.open_requests > 0) PrintPlain(stdout, " open-requests {}", reply.open_requests);
  PrintPlain(stdout, "\n");
}

// An absolute path if the source names a file: the service may have another working folder.
std::string AbsolutePath(const std::string& source) {
  const std::size_t end = std::min(source.rfind('#'), source.size());
  const std::string ending = std::filesystem::path(source.substr(0, end)).extension().string();
  if (ending != ".world" && ending != ".inc" && ending != ".json" && ending != ".yaml" && ending != ".yml")
    return source;
  return std::filesystem::absolute(source).lexically_normal().string();
}

// Exceptions come from DDS alone, and end as errors of the command.
int CtlCommand(CtlOptions options) {
  if (auto* const spawn = std::get_if<control::Spawn>(&options.request)) spawn->source = AbsolutePath(spawn->source);
  if (auto* const load = std::get_if<control::LoadWorld>(&options.request)) load->source = AbsolutePath(load->source);
  try {
    const Result<ControlReply> reply = SendRequest(options);
    if (!reply.ok()) return Fail(reply.error());
    if (!reply.value().done) return Fail(Failure(reply.value().problem));
    if (options.lists_agents) {
      PrintAgents(reply.value());
    } else {
      Print(options.request, reply.value());
    }
    return kExitDone;
  } catch (const std::exception& exception) {
    return Fail(FailureOf(exception));
  }
}

// The options of one `troupe ctl`; its actions share them.
using SharedOptions = std::shared_ptr<CtlOptions>;

// An action, and the request whose parameters are its options.
template <typename Request>
struct Action {
  CLI::App* app;
  std::shared_ptr<Request> request;
};

template <typename Request>
Action<Request> AddAction(CLI::App* command, const SharedOptions& options, const char* name, const char* help) {
  Action<Request> action{command->add_subcommand(name, help)->fallthrough(), std::make_shared<Request>()};
  action.app->callback([options, request = action.request] { options->request = *request; });
  return action;
}

template <typename Request>
void AddName(const Action<Request>& action, const char* help = "Name of a robot, an object or a model") {
  action.app->add_option("NAME", action.request->name, help)->required();
}

CLI::Option* AddPose(CLI::App* action, const SharedOptions& options, const char* help) {
  const auto check = [](const std::string& text) {
    const Result<PoseText> pose = ParsePoseText(text);
    return pose.ok() ? std::string() : pose.error().message;
  };
  return action->add_option("--pose", options->pose, help)
      ->check(CLI::Validator(check, ""))
      ->type_name("X,Y[,Z],HEADING");
}

// Options of a reset of some parts only.
void AddResetScopes(const Action<control::Reset>& reset) {
  const auto add = [&](const char* name, const char* help, std::uint8_t scope) {
    reset.app->add_flag_callback(
        name,
        [request = reset.request, scope] {
          std::uint8_t& scopes = request->scopes;
          scopes = static_cast<std::uint8_t>((scopes == kResetAll ? 0 : scopes) | scope);
        },
        help);
  };
  add("--time", "Reset the time to tick 0", kResetTime);
  add("--state", "Reset the states of robots and objects", kResetState);
  add("--spawned", "Delete all spawned entities", kResetSpawned);
}

void AddTimeActions(CLI::App* command, const SharedOptions& options) {
  AddAction<control::GetStatus>(command, options, "status",
                                "Print the state of the run: playing or paused, tick, state hash");
  AddAction<control::Pause>(command, options, "pause", "Pause the run at the end of the current tick");
  AddAction<control::Play>(command, options, "play", "Resume the run");
  const auto step =
      AddAction<control::Step>(command, options, "step", "Run a paused run for some ticks, and pause it again");
  step.app->add_option("TICKS", step.request->ticks, "Number of ticks (default: 1)")->check(WholeNumber(1));
  const auto speed = AddAction<control::Speed>(command, options, "speed", "Set the speed of the run");
  speed.app
      ->add_option_function<std::string>(
          "SPEED", [request = speed.request](const std::string& text) { request->speed = ParseSpeed(text).value(); },
          "Multiple of real time; max: as fast as possible")
      ->required()
      ->check(SpeedValue())
      ->type_name("X|max");
  const auto rewind = AddAction<control::Rewind>(
      command, options, "rewind",
      "Set the run back to an earlier tick, by its recording; controllers remember the ticks before");
  rewind.app->add_option("TICK", rewind.request->tick, "The tick")->check(WholeNumber(0))->required();
}

void AddSpawn(CLI::App* command, const SharedOptions& options) {
  const auto spawn =
      AddAction<control::Spawn>(command, options, "spawn", "Add a robot, an object or a model to the world");
  control::Spawn& request = *spawn.request;
  spawn.app
      ->add_option("SOURCE", request.source, "A model of the run's world file, a file with one model, or FILE#MODEL")
      ->required();
  spawn.app->add_option("--name", request.name, "Its name (default: derived from the model)")->type_name("NAME");
  spawn.app->add_flag("--rename", request.rename, "Choose another name if this one is in use");
  spawn.app
      ->add_option(
          "--ros-domain", request.ros_domain,
          "Its own ROS domain, with plain names (default: as its spawn rule or file says, else that of the run)")
      ->check(DdsDomain())
      ->type_name("D");
  spawn.app
      ->add_option("--controller", request.controller,
                   "Controller of the robot, with its default parameters (default: as the model says)")
      ->type_name("NAME");
  AddPose(spawn.app, options,
          "Pose in the world frame, in metres and degrees; without Z on the ground (default: 0,0,0)");
}

void AddEditActions(CLI::App* command, const SharedOptions& options) {
  AddResetScopes(
      AddAction<control::Reset>(command, options, "reset",
                                "Reset the run to the world as loaded, at tick 0; with options: the named parts only"));
  const auto load = AddAction<control::LoadWorld>(command, options, "load", "Replace the world by that of a file");
  AddWorldFile(*load.app, load.request->source);
  AddSpawn(command, options);
  AddName(AddAction<control::Delete>(command, options, "delete", "Delete a robot, an object or a model"));
  const auto restore =
      AddAction<control::Restore>(command, options, "restore", "Add a deleted robot, object or model again");
  restore.app->add_option("NAME", restore.request->source, "Its name when it was deleted")->required();
  restore.app->add_option("--name", restore.request->name, "Its name from now on (default: the same)")
      ->type_name("NAME");
  AddPose(restore.app, options, "Pose in the world frame, in metres and degrees; without Z on the ground")->required();
  const auto move =
      AddAction<control::SetPose>(command, options, "set-pose", "Move a robot, an object or a model to a pose");
  AddName(move);
  AddPose(move.app, options, "Pose in the world frame, in metres and degrees; without Z at its present height")
      ->required();
}

void AddDeviceActions(CLI::App* command, const SharedOptions& options) {
  const auto door = AddAction<control::Door>(command, options, "door", "Open or close a door");
  AddName(door, "Its name");
  door.app
      ->add_option_function<std::string>(
          "ACTION",
          [request = door.request](const std::string& action) { request->opening = action == "open" ? 1.0 : 0.0; },
          "open or close")
      ->required()
      ->check(CLI::IsMember({"open", "close"}))
      ->type_name("open|close");
  const auto lift = AddAction<control::Lift>(command, options, "lift", "Call a lift to a floor");
  AddName(lift, "Its name");
  lift.app->add_option("FLOOR", lift.request->floor, "The name of the floor")->required();
  const auto light = AddAction<control::Light>(command, options, "light", "Switch a light of a robot on or off");
  AddName(light, "Its name, with that of the robot: r0.beacon");
  light.app
      ->add_option_function<std::string>(
          "ACTION", [request = light.request](const std::string& action) { request->on = action == "on"; }, "on or off")
      ->required()
      ->check(CLI::IsMember({"on", "off"}))
      ->type_name("on|off");
}

void AddListActions(CLI::App* command, const SharedOptions& options) {
  AddAction<control::Entities>(command, options, "list",
                               "List the robots, objects and people of the world with their poses");
  AddName(AddAction<control::Entities>(
      command, options, "get", "Print the pose of a robot, an object, a person, a model or a place, and its signals"));
  AddAction<control::Entities>(command, options, "agents",
                               "List the agents of the robots: host, process id, time to answer a frame")
      .app->callback([options] {
        options->request = control::Entities();
        options->lists_agents = true;
      });
  AddAction<control::Spawnables>(command, options, "spawnables", "List the models of the run's world file");
}

}  // namespace

void AddCtlCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("ctl", "Pause, resume or step a run, or edit its world");
  const auto options = std::make_shared<CtlOptions>();
  command->require_subcommand(1);
  AddSessionFlag(*command, options->network, "Session of the run (default: the only one in the domain)");
  AddToolNetworkFlags(*command, options->network);
  command->add_option("--timeout", options->timeout_seconds, "Seconds to wait for the reply; 0: no limit (default)")
      ->check(NumberFromZero())
      ->type_name("SECONDS");
  AddTimeActions(command, options);
  AddEditActions(command, options);
  AddDeviceActions(command, options);
  AddListActions(command, options);
  command->final_callback([options, &exit_status] { exit_status = CtlCommand(*options); });
}

}  // namespace troupe
