// script: a timed list of commands.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robot-agent/controller/built_in.h"
#include "troupe/controller.h"
#include "troupe/result.h"

namespace troupe {
namespace {

// The parameters of the controller `script`, as read from JSON; docs/controllers.md has their format.

// The part of a command for one gripper. Without a name: for the robot's only one.
struct ScriptGripper {
  std::string name;
  std::optional<FingerCommand> fingers = {};
  std::optional<double> lift = {};  // percent
};

struct ScriptJoint {
  std::string name;
  double position = 0.0;  // m or rad
};

struct ScriptCamera {
  std::string name;
  double pan = 0.0;  // rad
  double tilt = 0.0;
};

struct ScriptCommand {
  double at = 0.0;          // s, simulated
  Command motion;           // its twist, or a car's speed and steering; no more
  bool for_car = false;     // it gives speed or steering
  bool for_others = false;  // it gives vx, vy or wz
  std::vector<ScriptGripper> grippers;
  std::vector<ScriptJoint> joints;
  std::vector<std::pair<std::string, bool>> lights;        // by name: on
  std::vector<std::pair<std::string, double>> doors;       // by name: opening, from 0 to 1
  std::vector<std::pair<std::string, std::string>> lifts;  // by name: a floor; empty: ends the session
  std::vector<ScriptCamera> cameras;
  std::optional<std::string> say;   // a text for people
  std::optional<std::string> send;  // a text, by the robot's first radio to all in range
};

struct ScriptParameters {
  std::vector<ScriptCommand> commands;  // never empty, in order of their times
  double period = 0.0;                  // s; 0: no repetition
};

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

// The error names the controller.
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

// A command is due at its time up to this much rounding in the tick's time, s.
constexpr double kTimeTolerance = 1e-9;

// The same commands, with the robot's numbers for the names of grippers and joints.
struct ResolvedCommand {
  double at = 0.0;  // s
  Command command;
};

class ScriptController final : public Controller {
 public:
  ScriptController(std::vector<ResolvedCommand> commands, double period)
      : commands_(std::move(commands)), period_(period) {}

  Command Update(const Observation& observation) override {
    double time = observation.time + kTimeTolerance;
    std::uint64_t round = 0;
    if (period_ > 0.0) {
      const double in_round = std::fmod(time, period_);
      round = static_cast<std::uint64_t>(std::llround((time - in_round) / period_));
      time = in_round;
    }
    std::size_t due = 0;
    while (due < commands_.size() && commands_[due].at <= time) ++due;
    Command command;  // before the first command it stands still
    if (due > 0) command = commands_[due - 1].command;
    Manipulate(round * commands_.size() + due, command);
    return command;
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<ScriptController>(*this); }

 private:
  // Commands to grippers, joints, lights, cameras and doors stay valid, and messages and texts are given once, so each
  // is given once: those due since the last call, in order. After a late start, those of one whole round at most.
  void Manipulate(std::uint64_t due, Command& command) {
    command.grippers.clear();
    command.joints.clear();
    command.messages.clear();
    command.lights.clear();
    command.cameras.clear();
    command.doors.clear();
    command.lifts.clear();
    command.say.clear();
    const std::uint64_t count = commands_.size();
    for (std::uint64_t i = std::max(given_, due > count ? due - count : 0); i < due; ++i) {
      const Command& given = commands_[i % count].command;
      command.grippers.insert(command.grippers.end(), given.grippers.begin(), given.grippers.end());
      command.joints.insert(command.joints.end(), given.joints.begin(), given.joints.end());
      command.messages.insert(command.messages.end(), given.messages.begin(), given.messages.end());
      command.lights.insert(command.lights.end(), given.lights.begin(), given.lights.end());
      command.cameras.insert(command.cameras.end(), given.cameras.begin(), given.cameras.end());
      command.doors.insert(command.doors.end(), given.doors.begin(), given.doors.end());
      command.lifts.insert(command.lifts.end(), given.lifts.begin(), given.lifts.end());
      if (!given.say.empty()) command.say = given.say;
    }
    given_ = due;
  }

  std::vector<ResolvedCommand> commands_;
  double period_;
  std::uint64_t given_ = 0;  // commands, in all rounds
};

Status CheckScript(const std::string& parameters) {
  const Result<ScriptParameters> parsed = ParseScript(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

Error ScriptError(std::string message) {
  return {{}, std::move(message)};
}

// The error is a motion that the drive cannot execute.
Status CheckMotion(DriveType drive, const ScriptCommand& command) {
  switch (drive) {
    case DriveType::kCar:
      if (command.for_others)
        return ScriptError("a car is driven by 'speed' and 'steering', not by 'vx', 'vy' and 'wz'");
      return {};
    case DriveType::kDifferential:
      if (command.motion.twist.vy != 0.0) return ScriptError("a differential drive has no 'vy'");
      [[fallthrough]];
    case DriveType::kOmni:
      if (command.for_car)
        return ScriptError("only a car is driven by 'speed' and 'steering', expected 'vx', 'vy' and 'wz'");
      return {};
  }
  return {};
}

// "none" or "one of: a, b"
template <typename Things, typename NameOf>
std::string Names(const Things& things, NameOf name_of) {
  std::string names;
  for (const auto& thing : things) names += (names.empty() ? "one of: " : ", ") + name_of(thing);
  return names.empty() ? "none" : names;
}

Result<GripperCommand> ResolveGripper(const RobotInfo& info, const ScriptGripper& gripper) {
  const auto name_of = [](const GripperInfo& g) { return g.description->name; };
  std::size_t number = 0;
  if (gripper.name.empty()) {
    if (info.grippers.empty()) return ScriptError("the robot has no gripper");
    if (info.grippers.size() > 1) {
      return ScriptError(fmt::format("the robot has {} grippers, expected 'grippers' with {}", info.grippers.size(),
                                     Names(info.grippers, name_of)));
    }
  } else {
    while (number < info.grippers.size() && name_of(info.grippers[number]) != gripper.name) ++number;
    if (number == info.grippers.size()) {
      return ScriptError(fmt::format("unknown gripper '{}', expected {}", gripper.name, Names(info.grippers, name_of)));
    }
  }
  if (gripper.lift && !info.grippers[number].lift) {
    return ScriptError(fmt::format("gripper '{}' has no lift", name_of(info.grippers[number])));
  }
  return GripperCommand{number, gripper.fingers, gripper.lift};
}

Result<JointCommand> ResolveJoint(const RobotInfo& info, const ScriptJoint& wanted) {
  for (const GripperInfo& gripper : info.grippers) {
    for (std::size_t finger : {gripper.left, gripper.right}) {
      if (info.joints[finger]->name == wanted.name) {
        return ScriptError(
            fmt::format("joint '{}' is a finger, expected 'gripper': \"open\" or \"close\"", wanted.name));
      }
    }
  }
  for (std::size_t i = 0; i < info.joints.size(); ++i) {
    const JointDescription& joint = *info.joints[i];
    if (joint.name != wanted.name) continue;
    if (wanted.position < joint.position.min || wanted.position > joint.position.max) {
      return ScriptError(fmt::format("joint '{}' is to go to {}, expected {} to {}", joint.name, wanted.position,
                                     joint.position.min, joint.position.max));
    }
    return JointCommand{.joint = i, .position = wanted.position};
  }
  return ScriptError(fmt::format("unknown joint '{}', expected {}", wanted.name,
                                 Names(info.joints, [](const JointDescription* joint) { return joint->name; })));
}

Result<LightCommand> ResolveLight(const RobotInfo& info, const std::string& name, bool on) {
  for (std::size_t i = 0; i < info.lights.size(); ++i) {
    if (info.lights[i].name == name) return LightCommand{i, on};
  }
  return ScriptError(fmt::format("unknown light '{}', expected {}", name,
                                 Names(info.lights, [](const LightInfo& light) { return std::string(light.name); })));
}

Result<CameraCommand> ResolveCamera(const RobotInfo& info, const ScriptCamera& wanted) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < info.sensors.size(); ++i) {
    if (FindCamera(*info.robot, i) == nullptr) continue;
    names.push_back(info.sensors[i].description->name);
    if (names.back() == wanted.name) return CameraCommand{i, wanted.pan, wanted.tilt};
  }
  return ScriptError(fmt::format("unknown camera '{}', expected {}", wanted.name,
                                 Names(names, [](const std::string& name) { return name; })));
}

Result<DoorCommand> ResolveDoor(const RobotInfo& info, const std::string& name, double opening) {
  for (std::size_t i = 0; i < info.doors.size(); ++i) {
    if (info.doors[i].name == name) return DoorCommand{i, opening};
  }
  return ScriptError(fmt::format("unknown door '{}', expected {}", name,
                                 Names(info.doors, [](const DoorInfo& door) { return door.name; })));
}

Result<LiftCommand> ResolveLift(const RobotInfo& info, const std::string& name, const std::string& floor) {
  for (std::size_t i = 0; i < info.lifts.size(); ++i) {
    if (info.lifts[i].name != name) continue;
    if (floor.empty()) return LiftCommand{i, 0, true};
    const std::vector<std::string>& floors = info.lifts[i].floors;
    const auto found = std::find(floors.begin(), floors.end(), floor);
    if (found != floors.end()) return LiftCommand{i, static_cast<std::size_t>(found - floors.begin())};
    return ScriptError(fmt::format("unknown floor '{}' of lift '{}', expected {}", floor, name,
                                   Names(floors, [](const std::string& text) { return text; })));
  }
  return ScriptError(fmt::format("unknown lift '{}', expected {}", name,
                                 Names(info.lifts, [](const LiftInfo& lift) { return lift.name; })));
}

// The error is something that the robot does not have.
Result<ResolvedCommand> Resolve(const RobotInfo& info, const ScriptCommand& command) {
  ResolvedCommand resolved{command.at, command.motion};
  if (Status status = CheckMotion(info.robot->drive.type, command); !status.ok()) return status.error();
  for (const ScriptGripper& gripper : command.grippers) {
    const Result<GripperCommand> found = ResolveGripper(info, gripper);
    if (!found.ok()) return found.error();
    resolved.command.grippers.push_back(found.value());
  }
  for (const ScriptJoint& joint : command.joints) {
    const Result<JointCommand> found = ResolveJoint(info, joint);
    if (!found.ok()) return found.error();
    resolved.command.joints.push_back(found.value());
  }
  if (command.send) {
    std::size_t radio = 0;
    while (radio < info.sensors.size() && FindRadio(*info.robot, radio) == nullptr) ++radio;
    if (radio == info.sensors.size()) return ScriptError("the robot has no radio");
    resolved.command.messages.push_back({.radio = radio, .bytes = {command.send->begin(), command.send->end()}});
  }
  for (const auto& [name, on] : command.lights) {
    const Result<LightCommand> found = ResolveLight(info, name, on);
    if (!found.ok()) return found.error();
    resolved.command.lights.push_back(found.value());
  }
  for (const ScriptCamera& camera : command.cameras) {
    const Result<CameraCommand> found = ResolveCamera(info, camera);
    if (!found.ok()) return found.error();
    resolved.command.cameras.push_back(found.value());
  }
  for (const auto& [name, opening] : command.doors) {
    const Result<DoorCommand> found = ResolveDoor(info, name, opening);
    if (!found.ok()) return found.error();
    resolved.command.doors.push_back(found.value());
  }
  for (const auto& [name, floor] : command.lifts) {
    const Result<LiftCommand> found = ResolveLift(info, name, floor);
    if (!found.ok()) return found.error();
    resolved.command.lifts.push_back(found.value());
  }
  resolved.command.say = command.say.value_or("");
  return resolved;
}

Result<std::unique_ptr<Controller>> CreateScript(const RobotInfo& info) {
  const Result<ScriptParameters> script = ParseScript(info.parameters);
  if (!script.ok()) return script.error();
  std::vector<ResolvedCommand> commands;
  for (const ScriptCommand& command : script.value().commands) {
    Result<ResolvedCommand> resolved = Resolve(info, command);
    if (!resolved.ok()) {
      return ScriptError(fmt::format("script: command {}: {}", commands.size() + 1, resolved.error().message));
    }
    commands.push_back(std::move(resolved).value());
  }
  return std::unique_ptr<Controller>(std::make_unique<ScriptController>(std::move(commands), script.value().period));
}

}  // namespace

BuiltInController Script() {
  return {"script", CheckScript, CreateScript};
}

}  // namespace troupe
