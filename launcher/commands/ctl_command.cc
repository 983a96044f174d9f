#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <variant>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "common/base/print.h"
#include "launcher/commands/commands.h"
#include "launcher/commands/request_options.h"
#include "transport/dds/tools/control_client.h"
#include "transport/dds/tools/session_monitor.h"
#include "transport/protocol/message_texts.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

struct CtlOptions {
  NetworkSettings network;  // session empty: the only one
  control::Request request;
  double timeout_seconds = 0.0;  // 0: no limit
  bool has_height = false;       // of the pose of the request
  bool lists_agents = false;     // of the entities
};

// A moved entity keeps its height, unless the command line has one.
Status SetHeight(const CtlOptions& options, ControlClient& client, control::Request& request) {
  auto* const move = std::get_if<control::SetPose>(&request);
  if (move == nullptr || options.has_height) return Status();
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
  if (Status missing = client.WaitForService(kDiscoverySeconds); !missing.ok()) {
    return Failure(missing.error().message + SimilarSession(network));
  }
  control::Request request = options.request;
  if (Status failure = SetHeight(options, client, request); !failure.ok()) return failure.error();
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
  constexpr std::array kFiles = {".world", ".inc", ".json", ".yaml", ".yml", ".sdf", ".urdf", ".xacro"};
  if (std::find(kFiles.begin(), kFiles.end(), ending) == kFiles.end()) return source;
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
Action<Request> AddAction(CLI::App* command, const SharedOptions& options, const std::string& name,
                          const std::string& help) {
  Action<Request> action{command->add_subcommand(name, help)->fallthrough(), std::make_shared<Request>()};
  action.app->callback([options, request = action.request] { options->request = *request; });
  return action;
}

// Options of a reset of some parts only.
void AddParameters(const Action<control::Reset>& reset, const SharedOptions& /*options*/) {
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
template <typename Request>
void AddParameters(const Action<Request>& action, const SharedOptions& options) {
  RequestOptions(*action.app, options->has_height).AddAll(*action.request);
}

template <typename Request>
void AddActionOf(CLI::App* command, const SharedOptions& options) {
  if constexpr (requires { Request::kHelp; }) {
    AddParameters(AddAction<Request>(command, options, WithDashes(Request::kName), std::string(Request::kHelp)),
                  options);
  }
}

// Each request with a help text is an action.
template <std::size_t... I>
void AddActions(CLI::App* command, const SharedOptions& options, std::index_sequence<I...>) {
  (AddActionOf<std::variant_alternative_t<I, control::Request>>(command, options), ...);
}

// One request has three actions.
void AddListActions(CLI::App* command, const SharedOptions& options) {
  AddAction<control::Entities>(command, options, "list",
                               "List the robots, objects and people of the world with their poses");
  const auto get = AddAction<control::Entities>(
      command, options, "get", "Print the pose of a robot, an object, a person, a model or a place, and its signals");
  get.app->add_option("NAME", get.request->name, "Name of a robot, an object, a person, a model or a place")
      ->required();
  AddAction<control::Entities>(command, options, "agents",
                               "List the agents of the robots: host, process id, time to answer a frame")
      .app->callback([options] {
        options->request = control::Entities();
        options->lists_agents = true;
      });
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
  AddActions(command, options, std::make_index_sequence<std::variant_size_v<control::Request>>());
  AddListActions(command, options);
  command->final_callback([options, &exit_status] { exit_status = CtlCommand(*options); });
}

}  // namespace troupe
