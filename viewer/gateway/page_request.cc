#include "viewer/gateway/page_request.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "transport/protocol/run_state_text.h"
#include "viewer/gateway/page_robot_command.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

struct CommandName {
  const char* name;
  ControlCommand command;
};

constexpr std::array<CommandName, 14> kCommands = {{{"status", ControlCommand::kStatus},
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
                                                    {"rewind", ControlCommand::kRewind}}};

constexpr std::uint64_t kMostTicks = 1'000'000;

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

std::optional<Pose> PoseIn(const Json& object) {
  const auto member = object.find("pose");
  if (member == object.end() || !member->is_array() || member->size() != 4) return std::nullopt;
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!(*member)[i].is_number()) return std::nullopt;
    numbers[i] = (*member)[i].get<double>();
    if (!std::isfinite(numbers[i])) return std::nullopt;
  }
  return Pose{numbers[0], numbers[1], numbers[2], numbers[3]};
}

// A model of the run's world file, and no file.
bool IsModelName(const std::string& source) {
  if (source.empty() || source.find_first_of("/#") != std::string::npos) return false;
  for (const char* ending : {".world", ".inc", ".json", ".yaml", ".yml"}) {
    if (source.ends_with(ending)) return false;
  }
  return true;
}

Result<PageRequest> ParseControl(const Json& object) {
  PageControl control;
  const auto id = WholeNumberIn(object, "id");
  if (!id) return Malformed("no id", "a whole number");
  control.id = *id;
  const std::string name = TextIn(object, "command");
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
    Result<RobotCommand> robot = ParsePageRobotCommand(object);
    if (!robot.ok()) return robot.error();
    request.robot_command = std::move(robot).value();
  }
  if (*command == ControlCommand::kStep || *command == ControlCommand::kCommandRobot) {
    const auto ticks = WholeNumberIn(object, "ticks");
    if (!ticks || *ticks == 0 || *ticks > kMostTicks) return Malformed("no ticks", "1 to 1000000");
    request.ticks = *ticks;
  }
  if (*command == ControlCommand::kDelete || *command == ControlCommand::kSetPose ||
      *command == ControlCommand::kCommandRobot) {
    request.name = TextIn(object, "name");
    if (request.name.empty()) return Malformed("no name", "that of a robot, an object or a model");
  }
  if (*command == ControlCommand::kEntities) request.name = TextIn(object, "name");
  if (*command == ControlCommand::kSpawn) {
    request.source = TextIn(object, "source");
    if (!IsModelName(request.source)) return Malformed("source '" + request.source + "'", "a model of the world file");
    request.rename = true;
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
  return PageRequest(std::move(control));
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
  if (!robots->is_array() || robots->size() > kMostSelected) return Malformed("no list of robots", "up to 64 names");
  for (const Json& robot : *robots) {
    if (!robot.is_string()) return Malformed("a robot without a name", "a text");
    select.robots.push_back(robot.get<std::string>());
  }
  return PageRequest(std::move(select));
}

Result<PageRequest> ParseEdit(const Json& object, std::string_view text) {
  const auto id = WholeNumberIn(object, "id");
  std::string op = TextIn(object, "op");
  if (!id || op.empty()) return Malformed("an edit", "an id and an op");
  PageRequest request;
  request.emplace<EditRequest>(EditRequest{*id, std::move(op), std::string(text)});
  return request;
}

Result<PageRequest> ParseSeek(const Json& object) {
  const SeekRequest seek{WholeNumberIn(object, "position"), WholeNumberIn(object, "tick")};
  if (seek.position.has_value() == seek.tick.has_value()) return Malformed("a seek", "a position or a tick");
  PageRequest request;
  request.emplace<SeekRequest>(seek);
  return request;
}

}  // namespace

Result<PageRequest> ParsePageRequest(std::string_view text, std::size_t longest) {
  if (text.size() > longest) return Malformed("a long text", std::to_string(longest) + " bytes at most");
  const Json object = Json::parse(text, nullptr, false);
  if (!object.is_object()) return Malformed("a text", "a JSON object");
  const std::string type = TextIn(object, "type");
  if (type == "edit") return ParseEdit(object, text);
  if (text.size() > kLongestPageRequest) return Malformed("a long text", "at most 8192 bytes");
  if (type == "select") return ParseSelect(object);
  if (type == "control") return ParseControl(object);
  if (type == "seek") return ParseSeek(object);
  if (type == "live") {
    PageRequest live;
    live.emplace<LiveRequest>();
    return live;
  }
  return Malformed("type '" + type + "'", "select, control, seek or live");
}

bool IsQuestion(ControlCommand command) {
  return command == ControlCommand::kStatus || command == ControlCommand::kSpawnables ||
         command == ControlCommand::kEntities;
}

bool IsQuestion(const EditRequest& request) {
  constexpr std::array<std::string_view, 7> kQuestions = {"document", "text",  "palette", "help",
                                                          "entity",   "model", "bitmaps"};
  return std::find(kQuestions.begin(), kQuestions.end(), request.op) != kQuestions.end();
}

std::string EditReplyText(std::uint64_t id, const Result<std::string>& reply) {
  Json text = Json::object();
  if (reply.ok()) text = Json::parse(reply.value(), nullptr, false);
  if (!text.is_object()) text = Json::object();
  text["type"] = "reply";
  text["id"] = id;
  text["done"] = reply.ok();
  text["problem"] = reply.ok() ? "" : reply.error().message;
  if (!reply.ok()) text["conflict"] = reply.error().code == ErrorCode::kNoRoom;
  return text.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string PageReplyText(std::uint64_t id, const Result<ControlReply>& reply) {
  Json text = {{"type", "reply"}, {"id", id}};
  text["done"] = reply.ok() && reply.value().done;
  text["problem"] = reply.ok() ? reply.value().problem : reply.error().message;
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
  return text.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace troupe
