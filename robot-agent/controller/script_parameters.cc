#include "robot-agent/controller/script_parameters.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "robot-agent/controller/parameters.h"

namespace troupe {
namespace {

constexpr Interval kAny{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
constexpr Interval kFromZero{0.0, kAny.max};

void ReadMotion(Parameters& reader, ScriptCommand& command) {
  Command& motion = command.motion;
  for (const auto& [key, value] :
       {std::pair<const char*, double*>{"vx", &motion.twist.vx}, {"vy", &motion.twist.vy}, {"wz", &motion.twist.wz}}) {
    if (reader.ReadNumber(key, kAny, *value)) command.for_others = true;
  }
  for (const auto& [key, value] :
       {std::pair<const char*, double*>{"speed", &motion.speed}, {"steering", &motion.steering}}) {
    if (reader.ReadNumber(key, kAny, *value)) command.for_car = true;
  }
  if (command.for_car && command.for_others) {
    reader.Fail("gives both a twist (vx, vy, wz) and a car's command (speed, steering), expected one of them");
  }
}

// Keys `gripper` and `lift`. Returns whether there was one.
bool ReadGripper(Parameters& reader, ScriptGripper& gripper) {
  double close = 0.0;
  if (reader.ReadNumberOrName("gripper", {1.0, 0.0}, {{"open", 0.0}, {"close", 1.0}}, close)) {
    gripper.fingers = close != 0.0 ? FingerCommand::kClose : FingerCommand::kOpen;
  }
  double lift = 0.0;
  if (reader.ReadNumberOrName("lift", {0.0, 100.0}, {{"up", 100.0}, {"down", 0.0}}, lift)) gripper.lift = lift;
  return gripper.fingers || gripper.lift;
}

void ReadManipulation(Parameters& reader, ScriptCommand& command) {
  ScriptGripper only;
  if (ReadGripper(reader, only)) command.grippers.push_back(only);
  for (const auto& [name, value] : reader.ReadObject("grippers")) {
    ScriptGripper gripper;
    gripper.name = name;
    Parameters inner(fmt::format("gripper '{}'", name), value);
    if (!ReadGripper(inner, gripper)) inner.Fail("nothing to do, expected 'gripper' or 'lift'");
    if (const std::string error = inner.Finish(); !error.empty()) reader.Fail(error);
    if (name.empty()) reader.Fail("a gripper in 'grippers' has no name");
    command.grippers.push_back(gripper);
  }
  if (only.fingers || only.lift) {
    if (command.grippers.size() > 1) {
      reader.Fail("gives both 'grippers' and, for a robot's only gripper, 'gripper' or 'lift', expected one of them");
    }
  }
  for (const auto& [name, value] : reader.ReadObject("joints")) {
    ScriptJoint joint{name, 0.0};
    Parameters inner("joints", nlohmann::json{{name, value}});
    inner.ReadNumber(name.c_str(), kAny, joint.position);
    if (const std::string error = inner.Finish(); !error.empty()) reader.Fail(error);
    command.joints.push_back(joint);
  }
}

ScriptCommand ParseCommand(const nlohmann::json& entry, std::size_t number, double earliest, Parameters& script) {
  ScriptCommand command;
  Parameters reader(fmt::format("command {}", number), entry);
  if (!reader.ReadNumber("at", kFromZero, command.at)) {
    reader.Fail("'at' is missing, expected a time in seconds");
  }
  ReadMotion(reader, command);
  ReadManipulation(reader, command);
  if (number > 1 && command.at <= earliest) {
    reader.Fail(
        fmt::format("'at' is {}, expected a time after that of the command before it, {}", command.at, earliest));
  }
  if (const std::string error = reader.Finish(); !error.empty()) script.Fail(error);
  return command;
}

}  // namespace

std::string ParseScript(const std::string& text, ScriptParameters& p) {
  Parameters reader("script", text);
  for (const nlohmann::json& command : reader.ReadArray("commands")) {
    const double earliest = p.commands.empty() ? 0.0 : p.commands.back().at;
    p.commands.push_back(ParseCommand(command, p.commands.size() + 1, earliest, reader));
  }
  bool repeat = false;
  reader.ReadBool("repeat", repeat);
  double period = p.commands.empty() ? 0.0 : p.commands.back().at;
  const double shortest = period;
  const bool has_period = reader.ReadNumber("period", kFromZero, period);
  if (p.commands.empty()) reader.Fail("'commands' is missing or empty, expected a list of {\"at\": seconds, ...}");
  if (has_period && !repeat) reader.Fail("'period' is given without \"repeat\": true");
  if (repeat && period < shortest) {
    reader.Fail(fmt::format("'period' is {}, expected at least {}, the time of the last command", period, shortest));
  }
  if (repeat && period == 0.0) {
    reader.Fail("nothing to repeat: the last command is at 0 and there is no 'period', expected one of them above 0");
  }
  if (repeat) p.period = period;
  if (repeat && period == shortest && !p.commands.empty() &&
      !(p.commands.back().grippers.empty() && p.commands.back().joints.empty())) {
    reader.Fail("the last command only marks the end and is never done, expected none for grippers or joints in it");
  }
  return reader.Finish();
}

}  // namespace troupe
