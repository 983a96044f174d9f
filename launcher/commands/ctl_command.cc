#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

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
  ControlRequest request;
  double timeout_seconds = 0.0;  // 0: no limit
  std::string pose;              // text for ParsePoseText; empty: none
  bool lists_agents = false;     // of the entities
};

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

// The pose of the command line. Without a height an entity keeps the one that it has.
Status SetPoseOfRequest(const CtlOptions& options, ControlClient& client, ControlRequest& request) {
  if (options.pose.empty()) return Status();
  const Result<PoseText> pose = ParsePoseText(options.pose);
  if (!pose.ok()) return pose.error();
  request.pose = pose.value().X_WE;
  if (pose.value().has_height || request.command != ControlCommand::kSetPose) return Status();
  ControlRequest question;
  question.command = ControlCommand::kEntities;
  question.name = request.name;
  const Result<ControlReply> reply = client.Call(question, options.timeout_seconds);
  if (!reply.ok()) return reply.error();
  if (!reply.value().done) return Failure(reply.value().problem);
  if (reply.value().entities.size() == 1) request.pose.z = reply.value().entities.front().X_WE.z;
  return Status();
}

Result<ControlReply> SendRequest(const CtlOptions& options) {
  NetworkSettings network = options.network;
  if (const Status problem = SelectSession(network); !problem.ok()) return problem.error();
  ControlClient client(network);
  if (Status missing = client.WaitForService(kDiscoverySeconds); !missing.ok()) return missing.error();
  ControlRequest request = options.request;
  if (Status failure = SetPoseOfRequest(options, client, request); !failure.ok()) return failure.error();
  return client.Call(request, options.timeout_seconds);
}

void Print(const EntityReport& entity) {
  const Pose& X_WE = entity.X_WE;
  PrintPlain(stdout, "{:<6} {:<24} {:<12} {:.3f},{:.3f},{:.3f},{:.2f}\n", Word(entity.kind), entity.name, entity.type,
             X_WE.x, X_WE.y, X_WE.z, RadiansToDegrees(X_WE.heading));
}

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

void Print(ControlCommand command, const ControlReply& reply) {
  if (command == ControlCommand::kSpawnables) {
    for (const EntityReport& model : reply.entities) PrintPlain(stdout, "{:<24} {}\n", model.name, model.type);
    return;
  }
  for (const EntityReport& entity : reply.entities) Print(entity);
  if (command == ControlCommand::kEntities) return;
  PrintPlain(stdout, "{} tick {} hash {:016x}", ToString(reply.state), reply.tick, reply.state_hash);
  if (reply.edition > 0) PrintPlain(stdout, " edition {}", reply.edition);
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

int CtlCommand(CtlOptions options) {
  options.request.source = AbsolutePath(options.request.source);
  try {
    const Result<ControlReply> reply = SendRequest(options);
    if (!reply.ok()) return Fail(reply.error());
    if (!reply.value().done) return Fail(Failure(reply.value().problem));
    if (options.lists_agents) {
      PrintAgents(reply.value());
    } else {
      Print(options.request.command, reply.value());
    }
    return kExitDone;
  } catch (const std::exception& exception) {
    return Fail(FailureOf(exception));
  }
}

// The options of one `troupe ctl`; its actions share them.
using SharedOptions = std::shared_ptr<CtlOptions>;

CLI::App* AddAction(CLI::App* command, const SharedOptions& options, const char* name, const char* help,
                    ControlCommand request) {
  CLI::App* action = command->add_subcommand(name, help)->fallthrough();
  action->callback([options, request] { options->request.command = request; });
  return action;
}

void AddName(CLI::App* action, const SharedOptions& options) {
  action->add_option("NAME", options->request.name, "Name of a robot, an object or a model")->required();
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
void AddResetScopes(CLI::App* reset, const SharedOptions& options) {
  const auto add = [&](const char* name, const char* help, std::uint8_t scope) {
    reset->add_flag_callback(
        name,
        [options, scope] {
          std::uint8_t& scopes = options->request.scopes;
          scopes = static_cast<std::uint8_t>((scopes == kResetAll ? 0 : scopes) | scope);
        },
        help);
  };
  add("--time", "Reset the time to tick 0", kResetTime);
  add("--state", "Reset the states of robots and objects", kResetState);
  add("--spawned", "Delete all spawned entities", kResetSpawned);
}

void AddTimeActions(CLI::App* command, const SharedOptions& options) {
  AddAction(command, options, "status", "Print the state of the run: playing or paused, tick, state hash",
            ControlCommand::kStatus);
  AddAction(command, options, "pause", "Pause the run at the end of the current tick", ControlCommand::kPause);
  AddAction(command, options, "play", "Resume the run", ControlCommand::kPlay);
  AddAction(command, options, "step", "Run a paused run for some ticks, and pause it again", ControlCommand::kStep)
      ->add_option("TICKS", options->request.ticks, "Number of ticks (default: 1)")
      ->check(WholeNumber(1));
  AddAction(command, options, "speed", "Set the speed of the run", ControlCommand::kSpeed)
      ->add_option_function<std::string>(
          "SPEED", [options](const std::string& text) { options->request.speed = ParseSpeed(text).value(); },
          "Multiple of real time; max: as fast as possible")
      ->required()
      ->check(SpeedValue())
      ->type_name("X|max");
  AddAction(command, options, "rewind",
            "Set the run back to an earlier tick, by its recording; controllers remember the ticks before",
            ControlCommand::kRewind)
      ->add_option("TICK", options->request.ticks, "The tick")
      ->check(WholeNumber(0))
      ->required();
}

void AddEditActions(CLI::App* command, const SharedOptions& options) {
  AddResetScopes(AddAction(command, options, "reset",
                           "Reset the run to the world as loaded, at tick 0; with options: the named parts only",
                           ControlCommand::kReset),
                 options);
  AddWorldFile(*AddAction(command, options, "load", "Replace the world by that of a file", ControlCommand::kLoadWorld),
               options->request.source);
  CLI::App* const spawn =
      AddAction(command, options, "spawn", "Add a robot, an object or a model to the world", ControlCommand::kSpawn);
  spawn
      ->add_option("SOURCE", options->request.source,
                   "A model of the run's world file, a file with one model, or FILE#MODEL")
      ->required();
  spawn->add_option("--name", options->request.name, "Its name (default: derived from the model)")->type_name("NAME");
  spawn->add_flag("--rename", options->request.rename, "Choose another name if this one is in use");
  spawn
      ->add_option(
          "--ros-domain", options->request.ros_domain,
          "Its own ROS domain, with plain names (default: as its spawn rule or file says, else that of the run)")
      ->check(DdsDomain())
      ->type_name("D");
  spawn
      ->add_option("--controller", options->request.controller,
                   "Controller of the robot, with its default parameters (default: as the model says)")
      ->type_name("NAME");
  AddPose(spawn, options, "Pose in the world frame, in metres and degrees; without Z on the ground (default: 0,0,0)");
  AddName(AddAction(command, options, "delete", "Delete a robot, an object or a model", ControlCommand::kDelete),
          options);
  CLI::App* const restore =
      AddAction(command, options, "restore", "Add a deleted robot, object or model again", ControlCommand::kRestore);
  restore->add_option("NAME", options->request.source, "Its name when it was deleted")->required();
  restore->add_option("--name", options->request.name, "Its name from now on (default: the same)")->type_name("NAME");
  AddPose(restore, options, "Pose in the world frame, in metres and degrees; without Z on the ground")->required();
  CLI::App* const set_pose =
      AddAction(command, options, "set-pose", "Move a robot, an object or a model to a pose", ControlCommand::kSetPose);
  AddName(set_pose, options);
  AddPose(set_pose, options, "Pose in the world frame, in metres and degrees; without Z at its present height")
      ->required();
}

void AddDoorActions(CLI::App* command, const SharedOptions& options) {
  CLI::App* const door = AddAction(command, options, "door", "Open or close a door", ControlCommand::kDoor);
  door->add_option("NAME", options->request.name, "Its name")->required();
  door->add_option("ACTION", options->request.source, "open or close")
      ->required()
      ->check(CLI::IsMember({"open", "close"}))
      ->type_name("open|close");
  CLI::App* const lift = AddAction(command, options, "lift", "Call a lift to a floor", ControlCommand::kLift);
  lift->add_option("NAME", options->request.name, "Its name")->required();
  lift->add_option("FLOOR", options->request.source, "The name of the floor")->required();
}

void AddListActions(CLI::App* command, const SharedOptions& options) {
  AddAction(command, options, "list", "List the robots and objects of the world with their poses",
            ControlCommand::kEntities);
  AddName(AddAction(command, options, "get", "Print the pose of a robot, an object, a model or a place",
                    ControlCommand::kEntities),
          options);
  AddAction(command, options, "agents", "List the agents of the robots: host, process id, time to answer a frame",
            ControlCommand::kEntities)
      ->callback([options] {
        options->request.command = ControlCommand::kEntities;
        options->lists_agents = true;
      });
  AddAction(command, options, "spawnables", "List the models of the run's world file", ControlCommand::kSpawnables);
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
  AddDoorActions(command, options);
  AddListActions(command, options);
  command->final_callback([options, &exit_status] { exit_status = CtlCommand(*options); });
}

}  // namespace troupe
