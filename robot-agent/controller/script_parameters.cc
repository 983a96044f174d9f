#include "robot-agent/controller/script_parameters.h"

#include <fmt/format.h>

#include <limits>

#include "common/base/json_reader.h"

namespace troupe {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// Whether the robot is a car is known only when the controller is made: both forms are read here.
void ReadMotion(const JsonReader& reader, ScriptCommand& command) {
  Command& motion = command.motion;
  for (const auto& [key, value] :
       {std::pair<const char*, double*>{"vx", &motion.twist.vx}, {"vy", &motion.twist.vy}, {"wz", &motion.twist.wz}}) {
    command.for_others = reader.Read(key, *value) || command.for_others;
  }
  for (const auto& [key, value] :
       {std::pair<const char*, double*>{"speed", &motion.speed}, {"steering", &motion.steering}}) {
    command.for_car = reader.Read(key, *value) || command.for_car;
  }
  if (command.for_car && command.for_others) {
    reader.Fail("either a twist (vx, vy, wz) or a car's command (speed, steering)");
  }
}

// Keys `gripper` and `lift`; nothing if both are missing.
std::optional<ScriptGripper> ReadGripper(const JsonReader& reader, const std::string& name) {
  ScriptGripper gripper{.name = name};
  if (const std::optional<double> close = reader.Number("gripper", 1.0, 0.0, {{"open", 0.0}, {"close", 1.0}})) {
    gripper.fingers = *close != 0.0 ? FingerCommand::kClose : FingerCommand::kOpen;
  }
  gripper.lift = reader.Number("lift", 0.0, 100.0, {{"up", 100.0}, {"down", 0.0}});
  return gripper.fingers || gripper.lift ? std::optional(gripper) : std::nullopt;
}

// The members of the object of that key; none without it.
std::vector<JsonReader> MembersOf(const JsonReader& reader, const char* key) {
  const std::optional<JsonReader> object = reader.Find(key);
  return object ? object->Members() : std::vector<JsonReader>();
}

void ReadManipulation(const JsonReader& reader, ScriptCommand& command) {
  const std::optional<ScriptGripper> only = ReadGripper(reader, "");
  if (only) command.grippers.push_back(*only);
  for (const JsonReader& each : MembersOf(reader, "grippers")) {
    const std::optional<ScriptGripper> gripper = ReadGripper(each, each.key());
    each.RefuseOthers();
    if (!gripper || each.key().empty()) each.Fail("a name, with 'gripper' or 'lift'");
    if (gripper) command.grippers.push_back(*gripper);
  }
  if (only && command.grippers.size() > 1) {
    reader.Fail("either 'grippers' or, for a robot's only gripper, 'gripper' or 'lift'");
  }
  for (const JsonReader& joint : MembersOf(reader, "joints")) {
    joint.To(command.joints.emplace_back(ScriptJoint{joint.key()}).position);
  }
}

// Times grow from command to command; all other keys are optional.
ScriptCommand ParseCommand(const JsonReader& reader, std::optional<double> before) {
  ScriptCommand command;
  const std::optional<double> at = reader.Number("at", 0.0, kUnbounded);
  if (!at) reader.FailWithout("at", "a time in seconds");
  command.at = at.value_or(0.0);
  ReadMotion(reader, command);
  ReadManipulation(reader, command);
  command.send = reader.Optional<std::string>("send");
  command.say = reader.Optional<std::string>("say");
  for (const JsonReader& light : MembersOf(reader, "lights")) {
    bool on = false;
    light.To(on);
    command.lights.emplace_back(light.key(), on);
  }
  for (const JsonReader& door : MembersOf(reader, "doors")) {
    command.doors.emplace_back(door.key(), door.Number(0.0, 1.0, {{"open", 1.0}, {"close", 0.0}}).value_or(0.0));
  }
  for (const JsonReader& lift : MembersOf(reader, "lifts")) {
    lift.To(command.lifts.emplace_back(lift.key(), "").second);
  }
  for (const JsonReader& camera : MembersOf(reader, "cameras")) {
    ScriptCamera& turned = command.cameras.emplace_back(ScriptCamera{camera.key()});
    camera.Read("pan", turned.pan);
    camera.Read("tilt", turned.tilt);
    camera.RefuseOthers();
  }
  if (at && before && *at <= *before) {
    reader.Find("at")->Fail(fmt::format("a time after that of the command before it, {}", *before));
  }
  reader.RefuseOthers();
  return command;
}

}  // namespace

// Without a period a repeated script has that of its last command, which is then the first one again.
Result<ScriptParameters> ParseScript(const std::string& text) {
  ScriptParameters p;
  const JsonReader reader = JsonReader::OfText(text, "script");
  if (const std::optional<JsonReader> commands = reader.Find("commands")) {
    for (const JsonReader& command : commands->Items()) {
      p.commands.push_back(
          ParseCommand(command, p.commands.empty() ? std::nullopt : std::optional(p.commands.back().at)));
    }
  }
  bool repeat = false;
  reader.Read("repeat", repeat);
  const double shortest = p.commands.empty() ? 0.0 : p.commands.back().at;
  const std::optional<double> given_period = reader.Number("period", 0.0, kUnbounded);
  const double period = given_period.value_or(shortest);
  if (p.commands.empty()) reader.FailWithout("commands", "a list of {\"at\": seconds, ...}");
  if (given_period && !repeat) reader.FailWith("found 'period' without 'repeat', expected both, or none");
  if (repeat && period < shortest) {
    reader.FailWith(
        fmt::format("found {} as 'period', expected at least {}, the time of the last command", period, shortest));
  }
  if (repeat && period == 0.0) {
    reader.FailWith(
        "nothing to repeat: the last command is at 0 and there is no 'period', expected one of them above 0");
  }
  if (repeat) p.period = period;
  if (repeat && period == shortest && !p.commands.empty() &&
      !(p.commands.back().grippers.empty() && p.commands.back().joints.empty() && !p.commands.back().send &&
        !p.commands.back().say && p.commands.back().lights.empty() && p.commands.back().cameras.empty() &&
        p.commands.back().doors.empty() && p.commands.back().lifts.empty())) {
    reader.FailWith(
        "the last command only marks the end and is never done, expected none for grippers, joints, radios, lights, "
        "cameras, doors, lifts or texts in it");
  }
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

}  // namespace troupe
