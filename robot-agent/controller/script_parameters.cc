#include "robot-agent/controller/script_parameters.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "robot-agent/controller/built_in.h"

namespace troupe {
namespace {

constexpr Interval kAny{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
constexpr Interval kFromZero{0.0, kAny.max};

void ReadMotion(NestedParameters& reader, ScriptCommand& command) {
  Command& motion = command.motion;
  for (const auto& [key, value] :
       {std::pair<const char*, double*>{"vx", &motion.twist.vx}, {"vy", &motion.twist.vy}, {"wz", &motion.twist.wz}}) {
    if (const std::optional<double> number = reader.ReadNumber(key, kAny)) {
      *value = *number;
      command.for_others = true;
    }
  }
  for (const auto& [key, value] :
       {std::pair<const char*, double*>{"speed", &motion.speed}, {"steering", &motion.steering}}) {
    if (const std::optional<double> number = reader.ReadNumber(key, kAny)) {
      *value = *number;
      command.for_car = true;
    }
  }
  if (command.for_car && command.for_others) {
    reader.Fail("gives both a twist (vx, vy, wz) and a car's command (speed, steering), expected one of them");
  }
}

// Keys `gripper` and `lift`; nothing if both are missing.
std::optional<ScriptGripper> ReadGripper(NestedParameters& reader, const std::string& name) {
  ScriptGripper gripper{.name = name};
  if (const std::optional<double> close =
          reader.ReadNumberOrName("gripper", {1.0, 0.0}, {{"open", 0.0}, {"close", 1.0}})) {
    gripper.fingers = *close != 0.0 ? FingerCommand::kClose : FingerCommand::kOpen;
  }
  gripper.lift = reader.ReadNumberOrName("lift", {0.0, 100.0}, {{"up", 100.0}, {"down", 0.0}});
  return gripper.fingers || gripper.lift ? std::optional(gripper) : std::nullopt;
}

// An error of a part becomes one of the whole.
void Merge(const Status& part, NestedParameters& whole) {
  if (!part.ok()) whole.Fail(part.error().message);
}

void ReadManipulation(NestedParameters& reader, ScriptCommand& command) {
  const std::optional<ScriptGripper> only = ReadGripper(reader, "");
  if (only) command.grippers.push_back(*only);
  for (const auto& [name, value] : reader.ReadObject("grippers")) {
    NestedParameters inner(fmt::format("gripper '{}'", name), value);
    const std::optional<ScriptGripper> gripper = ReadGripper(inner, name);
    if (!gripper) inner.Fail("nothing to do, expected 'gripper' or 'lift'");
    Merge(inner.Finish(), reader);
    if (name.empty()) reader.Fail("a gripper in 'grippers' has no name");
    if (gripper) command.grippers.push_back(*gripper);
  }
  if (only && command.grippers.size() > 1) {
    reader.Fail("gives both 'grippers' and, for a robot's only gripper, 'gripper' or 'lift', expected one of them");
  }
  for (const auto& [name, value] : reader.ReadObject("joints")) {
    NestedParameters inner("joints", nlohmann::json{{name, value}});
    command.joints.push_back({name, inner.ReadNumber(name.c_str(), kAny).value_or(0.0)});
    Merge(inner.Finish(), reader);
  }
}

ScriptCommand ParseCommand(const nlohmann::json& entry, std::size_t number, double earliest, NestedParameters& script) {
  ScriptCommand command;
  NestedParameters reader(fmt::format("command {}", number), entry);
  const std::optional<double> at = reader.ReadNumber("at", kFromZero);
  if (!at) reader.Fail("'at' is missing, expected a time in seconds");
  command.at = at.value_or(0.0);
  ReadMotion(reader, command);
  ReadManipulation(reader, command);
  command.send = reader.ReadText("send");
  command.say = reader.ReadText("say");
  for (const auto& [name, value] : reader.ReadObject("lights")) {
    NestedParameters inner("lights", nlohmann::json{{name, value}});
    command.lights.emplace_back(name, inner.ReadBool(name.c_str()).value_or(false));
    Merge(inner.Finish(), reader);
  }
  for (const auto& [name, value] : reader.ReadObject("doors")) {
    NestedParameters inner("doors", nlohmann::json{{name, value}});
    command.doors.emplace_back(
        name, inner.ReadNumberOrName(name.c_str(), {0.0, 1.0}, {{"open", 1.0}, {"close", 0.0}}).value_or(0.0));
    Merge(inner.Finish(), reader);
  }
  for (const auto& [name, value] : reader.ReadObject("lifts")) {
    NestedParameters inner("lifts", nlohmann::json{{name, value}});
    command.lifts.emplace_back(name, inner.ReadText(name.c_str()).value_or(""));
    Merge(inner.Finish(), reader);
  }
  for (const auto& [name, value] : reader.ReadObject("cameras")) {
    NestedParameters inner(fmt::format("camera '{}'", name), value);
    command.cameras.push_back(
        {name, inner.ReadNumber("pan", kAny).value_or(0.0), inner.ReadNumber("tilt", kAny).value_or(0.0)});
    Merge(inner.Finish(), reader);
  }
  if (number > 1 && command.at <= earliest) {
    reader.Fail(
        fmt::format("'at' is {}, expected a time after that of the command before it, {}", command.at, earliest));
  }
  Merge(reader.Finish(), script);
  return command;
}

}  // namespace

Result<ScriptParameters> ParseScript(const std::string& text) {
  ScriptParameters p;
  NestedParameters reader("script", text);
  for (const nlohmann::json& command : reader.ReadArray("commands")) {
    const double earliest = p.commands.empty() ? 0.0 : p.commands.back().at;
    p.commands.push_back(ParseCommand(command, p.commands.size() + 1, earliest, reader));
  }
  const bool repeat = reader.ReadBool("repeat").value_or(false);
  const double shortest = p.commands.empty() ? 0.0 : p.commands.back().at;
  const std::optional<double> given_period = reader.ReadNumber("period", kFromZero);
  const double period = given_period.value_or(shortest);
  if (p.commands.empty()) reader.Fail("'commands' is missing or empty, expected a list of {\"at\": seconds, ...}");
  if (given_period && !repeat) reader.Fail("'period' is given without \"repeat\": true");
  if (repeat && period < shortest) {
    reader.Fail(fmt::format("'period' is {}, expected at least {}, the time of the last command", period, shortest));
  }
  if (repeat && period == 0.0) {
    reader.Fail("nothing to repeat: the last command is at 0 and there is no 'period', expected one of them above 0");
  }
  if (repeat) p.period = period;
  if (repeat && period == shortest && !p.commands.empty() &&
      !(p.commands.back().grippers.empty() && p.commands.back().joints.empty() && !p.commands.back().send &&
        !p.commands.back().say && p.commands.back().lights.empty() && p.commands.back().cameras.empty() &&
        p.commands.back().doors.empty() && p.commands.back().lifts.empty())) {
    reader.Fail(
        "the last command only marks the end and is never done, expected none for grippers, joints, radios, lights, "
        "cameras, doors, lifts or texts in it");
  }
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

}  // namespace troupe
