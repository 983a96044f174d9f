#include "viewer/gateway/page_request.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/json.h"
#include "transport/protocol/message_texts.h"
#include "troupe/world_description.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

struct CommandName {
  const char* name;
  ControlCommand command;
};

constexpr std::array<CommandName, 16> kCommands = {{{"status", ControlCommand::kStatus},
                                                    {"pause", ControlCommand::kPause},
                                                    {"play", ControlCommand::kPlay},
                                                    {"step", ControlCommand::kStep},
                                                    {"reset", ControlCommand::kReset},
                                                    {"spawn", ControlCommand::kSpawn},
                                                    {"delete", ControlCommand::kDelete},
                                                    {"entities", ControlCommand::kEntities},
                                                    {"set_pose", ControlCommand::kSetPose},
                                                    {"spawnables", ControlCommand::kSpawnables},
                                                    {"speed", ControlCommand::kSpeed},
                                                    {"command_robot", ControlCommand::kCommandRobot},
                                                    {"restore", ControlCommand::kRestore},
                                                    {"rewind", ControlCommand::kRewind},
                                                    {"door", ControlCommand::kDoor},
                                                    {"lift", ControlCommand::kLift}}};

constexpr std::uint64_t kMaxTicks = 1'000'000;
constexpr std::uint64_t kMaxPosition = std::uint64_t{1} << 53;
constexpr std::size_t kMaxOrders = 64;  // to grippers

Error Malformed(const std::string& found, const std::string& expected) {
  return {{}, "found " + found + ", expected " + expected};
}

std::optional<ControlCommand> FindCommand(const std::string& name) {
  for (const CommandName& known : kCommands) {
    if (name == known.name) return known.command;
  }
  return std::nullopt;
}

// Empty if the object has no text of that name.
std::string TextIn(const Json& object, const char* key) {
  const auto member = object.find(key);
  return member != object.end() && member->is_string() ? member->get<std::string>() : std::string();
}

std::optional<std::uint64_t> WholeNumberIn(const Json& object, const char* key) {
  const auto member = object.find(key);
  if (member == object.end() || !member->is_number_unsigned()) return std::nullopt;
  return member->get<std::uint64_t>();
}

std::optional<double> Number(const Json& value) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) return std::nullopt;
  return value.get<double>();
}

template <std::size_t kCount>
std::optional<std::array<double, kCount>> Numbers(const Json& value) {
  if (!value.is_array() || value.size() != kCount) return std::nullopt;
  std::array<double, kCount> numbers{};
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::optional<double> number = Number(value[i]);
    if (!number) return std::nullopt;
    numbers[i] = *number;
  }
  return numbers;
}

std::optional<Pose> PoseIn(const Json& object) {
  const auto member = object.find("pose");
  const auto numbers = member != object.end() ? Numbers<4>(*member) : std::nullopt;
  if (!numbers) return std::nullopt;
  return Pose{(*numbers)[0], (*numbers)[1], (*numbers)[2], (*numbers)[3]};
}

// A model of the run's world file, and no file.
bool IsModelName(const std::string& source) {
  if (source.empty() || source.find_first_of("/#") != std::string::npos) return false;
  for (const char* ending : {".world", ".inc", ".json", ".yaml", ".yml"}) {
    if (source.ends_with(ending)) return false;
  }
  return true;
}

Error MalformedCommand(const std::string& expected) {
  return Malformed("a malformed command of a robot", expected);
}

// False if there is a member of that name that is not a number.
bool ReadOptional(const Json& object, const char* key, std::optional<double>& value) {
  const auto member = object.find(key);
  if (member == object.end()) return true;
  value = Number(*member);
  return value.has_value();
}

Result<std::vector<GripperOrder>> ParseOrders(const Json& value) {
  if (!value.is_array() || value.size() > kMaxOrders) return MalformedCommand("a list of grippers");
  std::vector<GripperOrder> orders;
  for (const Json& element : value) {
    const auto number = element.is_object() ? element.find("gripper") : element.end();
    if (!element.is_object() || number == element.end() || !number->is_number_unsigned()) {
      return MalformedCommand("the number of a gripper");
    }
    GripperOrder& order = orders.emplace_back();
    order.gripper = number->get<std::size_t>();
    if (!ReadOptional(element, "opening", order.opening) || !ReadOptional(element, "lift", order.lift)) {
      return MalformedCommand("percentages of a gripper");
    }
  }
  return orders;
}

Result<Goal> ParseGoal(const Json& value) {
  Goal goal;
  const auto waypoints = value.is_object() ? value.find("waypoints") : value.end();
  if (!value.is_object() || waypoints == value.end() || !waypoints->is_array()) return MalformedCommand("waypoints");
  for (const Json& waypoint : *waypoints) {
    const auto point = Numbers<2>(waypoint);
    if (!point) return MalformedCommand("two coordinates of a waypoint");
    goal.waypoints.emplace_back((*point)[0], (*point)[1]);
  }
  if (!ReadOptional(value, "heading", goal.heading)) return MalformedCommand("the heading of a goal");
  return goal;
}

// The service of the run compares the command with its world.
Result<RobotCommand> ParseRobotCommand(const Json& object) {
  RobotCommand command;
  if (const auto twist = object.find("twist"); twist != object.end()) {
    const auto numbers = Numbers<3>(*twist);
    if (!numbers) return MalformedCommand("three numbers of a twist");
    command.twist = Twist{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
  }
  if (const auto grippers = object.find("grippers"); grippers != object.end()) {
    Result<std::vector<GripperOrder>> orders = ParseOrders(*grippers);
    if (!orders.ok()) return orders.error();
    command.grippers = std::move(orders).value();
  }
  if (const auto member = object.find("goal"); member != object.end()) {
    Result<Goal> goal = ParseGoal(*member);
    if (!goal.ok()) return goal.error();
    command.goal = std::move(goal).value();
  }
  if (!command.twist && command.grippers.empty() && !command.goal)
    return MalformedCommand("a twist, grippers or a goal");
  return command;
}

Result<PageControl> DecodeControl(std::uint64_t id, const std::string& name, const Json& object) {
  PageControl control;
  control.id = id;
  const auto command = FindCommand(name);
  if (!command) return Malformed("command '" + name + "'", "a command of the page");
  ControlRequest& request = control.request;
  request.command = *command;
  if (*command == ControlCommand::kRewind) {
    const auto tick = WholeNumberIn(object, "tick");
    if (!tick) return Malformed("no tick", "a whole number");
    request.ticks = *tick;
  }
  if (*command == ControlCommand::kSpeed) {
    const auto speed = object.find("speed");
    const bool is_number = speed != object.end() && speed->is_number() && std::isfinite(speed->get<double>());
    if (!is_number && TextIn(object, "speed") != "max") return Malformed("no speed", "a number or \"max\"");
    if (is_number && speed->get<double>() <= 0.0) return Malformed("a speed", "a positive one");
    if (is_number) request.speed = speed->get<double>();
  }
  if (*command == ControlCommand::kCommandRobot) {
    Result<RobotCommand> robot = ParseRobotCommand(object);
    if (!robot.ok()) return robot.error();
    request.robot_command = std::move(robot).value();
  }
  if (*command == ControlCommand::kStep || *command == ControlCommand::kCommandRobot) {
    const auto ticks = WholeNumberIn(object, "ticks");
    if (!ticks || *ticks == 0 || *ticks > kMaxTicks) return Malformed("no ticks", "1 to 1000000");
    request.ticks = *ticks;
  }
  if (*command == ControlCommand::kDelete || *command == ControlCommand::kSetPose ||
      *command == ControlCommand::kCommandRobot || *command == ControlCommand::kDoor ||
      *command == ControlCommand::kLift) {
    request.name = TextIn(object, "name");
    if (request.name.empty()) return Malformed("no name", "that of a robot, an object or a model");
  }
  if (*command == ControlCommand::kDoor) {
    request.source = TextIn(object, "action");
    if (request.source != "open" && request.source != "close") {
      return Malformed("action '" + request.source + "'", "open or close");
    }
  }
  if (*command == ControlCommand::kLift) request.source = TextIn(object, "floor");
  if (*command == ControlCommand::kEntities) request.name = TextIn(object, "name");
  if (*command == ControlCommand::kSpawn) {
    request.source = TextIn(object, "source");
    if (!IsModelName(request.source)) return Malformed("source '" + request.source + "'", "a model of the world file");
    request.rename = true;
    request.controller = TextIn(object, "controller");
    if (NamesLibrary(request.controller)) return Malformed("a library as controller", "the name of a built-in one");
  }
  if (*command == ControlCommand::kRestore) {
    request.source = TextIn(object, "source");
    request.name = TextIn(object, "name");
    if (request.source.empty() || request.name.empty()) return Malformed("no names", "source and name");
  }
  if (*command == ControlCommand::kSpawn || *command == ControlCommand::kRestore ||
      *command == ControlCommand::kSetPose) {
    const auto pose = PoseIn(object);
    if (!pose) return Malformed("no pose", "four finite numbers");
    request.pose = *pose;
  }
  return control;
}

Result<PageRequest> ParseSelect(const Json& object) {
  SelectRequest select;
  select.pictures = TextIn(object, "pictures");
  const auto robots = object.find("robots");
  if (robots == object.end()) return Malformed("no robots", "names, or \"all\"");
  if (robots->is_string() && robots->get<std::string>() == "all") {
    select.all = true;
    return PageRequest(std::move(select));
  }
  if (!robots->is_array() || robots->size() > kMaxSelected) return Malformed("no list of robots", "up to 64 names");
  for (const Json& robot : *robots) {
    if (!robot.is_string()) return Malformed("a robot without a name", "a text");
    select.robots.push_back(robot.get<std::string>());
  }
  return PageRequest(std::move(select));
}

Result<PageRequest> ParseEdit(const Json& object) {
  const auto id = WholeNumberIn(object, "id");
  if (!id || TextIn(object, "op").empty()) return Malformed("an edit", "an id and an op");
  return PageRequest(PageEdit{*id, DecodeEditOperation(object)});
}

Result<PageRequest> ParseSeek(const Json& object) {
  const SeekRequest seek{WholeNumberIn(object, "position"), WholeNumberIn(object, "tick")};
  if (seek.position.has_value() == seek.tick.has_value()) return Malformed("a seek", "a position or a tick");
  PageRequest request;
  request.emplace<SeekRequest>(seek);
  return request;
}

Result<PageRequest> ParseSeries(const Json& object) {
  SeriesRequest series;
  const auto id = WholeNumberIn(object, "id");
  const auto from = WholeNumberIn(object, "from");
  const auto to = WholeNumberIn(object, "to");
  const auto every = WholeNumberIn(object, "every");
  if (!id || !from || !to || !every || *every == 0 || *from > kMaxPosition || *every > kMaxPosition) {
    return Malformed("a series", "an id, from, to and every");
  }
  series.id = *id;
  series.from = *from;
  series.to = *to;
  series.every = *every;
  const auto signals = object.find("signals");
  if (signals == object.end() || !signals->is_array() || signals->size() > kMaxSignals) {
    return Malformed("no signals", "a list of up to 32");
  }
  for (const Json& signal : *signals) {
    const bool is_pair = signal.is_array() && signal.size() == 2 && signal[0].is_string() && signal[1].is_string();
    if (!is_pair) return Malformed("a signal", "the names of a thing and of its signal");
    series.signals.push_back({signal[0].get<std::string>(), signal[1].get<std::string>()});
  }
  return PageRequest(std::move(series));
}

}  // namespace

Result<PageRequest> ParsePageRequest(std::string_view text, std::size_t longest) {
  if (text.size() > longest) return Malformed("a long text", std::to_string(longest) + " bytes at most");
  const Json object = Json::parse(text, nullptr, false);
  if (!object.is_object()) return Malformed("a text", "a JSON object");
  const std::string type = TextIn(object, "type");
  if (type == "edit") return ParseEdit(object);
  if (text.size() > kMaxPageRequest) return Malformed("a long text", "at most 8192 bytes");
  if (type == "select") return ParseSelect(object);
  if (type == "control") {
    const auto id = WholeNumberIn(object, "id");
    if (!id) return Malformed("no id", "a whole number");
    Result<PageControl> control = DecodeControl(*id, TextIn(object, "command"), object);
    if (!control.ok()) return control.error();
    return PageRequest(std::move(control).value());
  }
  if (type == "seek") return ParseSeek(object);
  if (type == "live") {
    PageRequest live;
    live.emplace<LiveRequest>();
    return live;
  }
  if (type == "series") return ParseSeries(object);
  if (type == "totals") {
    const auto id = WholeNumberIn(object, "id");
    if (!id) return Malformed("no id", "a whole number");
    return PageRequest(TotalsRequest{*id});
  }
  if (type == "expectations") {
    const auto id = WholeNumberIn(object, "id");
    if (!id) return Malformed("no id", "a whole number");
    return PageRequest(ExpectationsRequest{*id});
  }
  if (type == "run_again") {
    const auto id = WholeNumberIn(object, "id");
    const auto seed = WholeNumberIn(object, "seed");
    if (!id || (object.contains("seed") && !seed)) return Malformed("a new run", "an id, and a whole number as seed");
    RunAgainRequest again{*id, seed};
    if (const auto values = object.find("values"); values != object.end()) {
      again.values.emplace();
      if (!values->is_array()) return Malformed("a new run", "an array of values");
      for (const Json& value : *values) {
        if (!value.is_array() || value.size() != 2 || !value[0].is_string()) {
          return Malformed("a new run", "values as arrays of a path and a value");
        }
        again.values->emplace_back(value[0].get<std::string>(), value[1].dump());
      }
    }
    return PageRequest(std::move(again));
  }
  return Malformed("type '" + type + "'", "select, control, seek, live, series, totals, expectations or run_again");
}

bool IsQuestion(ControlCommand command) {
  return command == ControlCommand::kStatus || command == ControlCommand::kSpawnables ||
         command == ControlCommand::kEntities;
}

Result<PageControl> ParseControl(std::uint64_t id, const std::string& command, std::string_view json) {
  if (json.size() > kMaxPageRequest) return Malformed("a long text", "at most 8192 bytes");
  Json object = Json::parse(json, nullptr, false);
  if (!object.is_object()) object = Json::object();
  return DecodeControl(id, command, object);
}

PageReply ReplyToEdit(std::uint64_t id, const Result<Json>& reply) {
  Json text = reply.ok() ? reply.value() : Json::object();
  const std::string problem = reply.ok() ? "" : reply.error().message;
  text["type"] = "reply";
  text["id"] = id;
  text["done"] = reply.ok();
  text["problem"] = problem;
  if (!reply.ok()) text["conflict"] = reply.error().code == ErrorCode::kNoRoom;
  return {id, reply.ok(), problem, JsonText(text)};
}

PageReply ReplyToControl(std::uint64_t id, const Result<ControlReply>& reply) {
  const bool done = reply.ok() && reply.value().done;
  const std::string& problem = reply.ok() ? reply.value().problem : reply.error().message;
  Json text = {{"type", "reply"}, {"id", id}, {"done", done}, {"problem", problem}};
  if (reply.ok()) {
    text["state"] = ToString(reply.value().state);
    text["tick"] = reply.value().tick;
    Json entities = Json::array();
    for (const EntityReport& entity : reply.value().entities) {
      Json& listed = entities.emplace_back(Json{{"name", entity.name}, {"type", entity.type}});
      if (!entity.agent) continue;
      listed["agent"] = {{"host", entity.agent->host},
                         {"pid", entity.agent->pid},
                         {"present", entity.agent->present},
                         {"answer_seconds", entity.agent->answer_seconds},
                         {"times_last", entity.agent->times_last}};
    }
    text["entities"] = std::move(entities);
  }
  return {id, done, problem, JsonText(text)};
}

}  // namespace troupe
