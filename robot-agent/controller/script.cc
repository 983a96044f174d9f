// script: a timed list of commands.
//
// Two kinds of parts of a command. A motion is a state: the last one that is due counts, in each tick. Commands to
// grippers, joints, devices and messages are events: each is given once, in the tick in which it is due, also when
// several are due at once. Both follow from the time of the observation, so that a robot that joins late continues at
// the right place.
//
// Names of grippers, joints, lights, doors and lifts are resolved when the controller is made: a wrong name is an error
// before the run.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/controller/script_parameters.h"
#include "troupe/controller.h"
#include "troupe/result.h"

namespace troupe {
namespace {

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
  // is given once: all that are due since the last call, in order. After a late start, one whole round at most.
  void Manipulate(std::uint64_t due, Command& command) {
    command.grippers.clear();
    command.joints.clear();
    command.messages.clear();
    command.orders.clear();
    command.say.clear();
    const std::uint64_t count = commands_.size();
    for (std::uint64_t i = std::max(given_, due > count ? due - count : 0); i < due; ++i) {
      const Command& given = commands_[i % count].command;
      command.grippers.insert(command.grippers.end(), given.grippers.begin(), given.grippers.end());
      command.joints.insert(command.joints.end(), given.joints.begin(), given.joints.end());
      command.messages.insert(command.messages.end(), given.messages.begin(), given.messages.end());
      command.orders.insert(command.orders.end(), given.orders.begin(), given.orders.end());
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

// The error is a motion that the drive cannot execute.
Status CheckMotion(DriveType drive, const ScriptCommand& command) {
  switch (drive) {
    case DriveType::kCar:
      if (command.for_others) return BadInput("a car is driven by 'speed' and 'steering', not by 'vx', 'vy' and 'wz'");
      return {};
    case DriveType::kDifferential:
      if (command.motion.twist.vy != 0.0) return BadInput("a differential drive has no 'vy'");
      [[fallthrough]];
    case DriveType::kOmni:
      if (command.for_car)
        return BadInput("only a car is driven by 'speed' and 'steering', expected 'vx', 'vy' and 'wz'");
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
    if (info.grippers.empty()) return BadInput("the robot has no gripper");
    if (info.grippers.size() > 1) {
      return BadInput(fmt::format("the robot has {} grippers, expected 'grippers' with {}", info.grippers.size(),
                                  Names(info.grippers, name_of)));
    }
  } else {
    while (number < info.grippers.size() && name_of(info.grippers[number]) != gripper.name) ++number;
    if (number == info.grippers.size()) {
      return BadInput(fmt::format("unknown gripper '{}', expected {}", gripper.name, Names(info.grippers, name_of)));
    }
  }
  if (gripper.lift && !info.grippers[number].lift) {
    return BadInput(fmt::format("gripper '{}' has no lift", name_of(info.grippers[number])));
  }
  return GripperCommand{number, gripper.fingers, gripper.lift};
}

Result<JointCommand> ResolveJoint(const RobotInfo& info, const ScriptJoint& wanted) {
  for (const GripperInfo& gripper : info.grippers) {
    for (std::size_t finger : {gripper.left, gripper.right}) {
      if (info.joints[finger]->name == wanted.name) {
        return BadInput(fmt::format("joint '{}' is a finger, expected 'gripper': \"open\" or \"close\"", wanted.name));
      }
    }
  }
  for (std::size_t i = 0; i < info.joints.size(); ++i) {
    const JointDescription& joint = *info.joints[i];
    if (joint.name != wanted.name) continue;
    if (wanted.position < joint.position.min || wanted.position > joint.position.max) {
      return BadInput(fmt::format("joint '{}' is to go to {}, expected {} to {}", joint.name, wanted.position,
                                  joint.position.min, joint.position.max));
    }
    return JointCommand{.joint = i, .position = wanted.position};
  }
  return BadInput(fmt::format("unknown joint '{}', expected {}", wanted.name,
                              Names(info.joints, [](const JointDescription* joint) { return joint->name; })));
}

Result<Order> ResolveLight(const RobotInfo& info, const std::string& name, bool on) {
  for (std::size_t i = 0; i < info.lights.size(); ++i) {
    if (info.lights[i].name == name) return Order(LightOrder{i, on});
  }
  return BadInput(fmt::format("unknown light '{}', expected {}", name,
                              Names(info.lights, [](const LightInfo& light) { return std::string(light.name); })));
}

Result<Order> ResolveCamera(const RobotInfo& info, const ScriptCamera& wanted) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < info.sensors.size(); ++i) {
    if (FindCamera(*info.robot, i) == nullptr) continue;
    names.push_back(info.sensors[i].description->name);
    if (names.back() == wanted.name) return Order(CameraOrder{i, wanted.pan, wanted.tilt});
  }
  return BadInput(fmt::format("unknown camera '{}', expected {}", wanted.name,
                              Names(names, [](const std::string& name) { return name; })));
}

Result<Order> ResolveDoor(const RobotInfo& info, const std::string& name, double opening) {
  for (std::size_t i = 0; i < info.doors.size(); ++i) {
    if (info.doors[i].name == name) return Order(DoorOrder{i, opening});
  }
  return BadInput(fmt::format("unknown door '{}', expected {}", name,
                              Names(info.doors, [](const DoorInfo& door) { return door.name; })));
}

Result<Order> ResolveLift(const RobotInfo& info, const std::string& name, const std::string& floor) {
  for (std::size_t i = 0; i < info.lifts.size(); ++i) {
    if (info.lifts[i].name != name) continue;
    if (floor.empty()) return Order(LiftOrder{i, 0, true});
    const std::vector<std::string>& floors = info.lifts[i].floors;
    const auto found = std::find(floors.begin(), floors.end(), floor);
    if (found != floors.end()) return Order(LiftOrder{i, static_cast<std::size_t>(found - floors.begin())});
    return BadInput(fmt::format("unknown floor '{}' of lift '{}', expected {}", floor, name,
                                Names(floors, [](const std::string& text) { return text; })));
  }
  return BadInput(fmt::format("unknown lift '{}', expected {}", name,
                              Names(info.lifts, [](const LiftInfo& lift) { return lift.name; })));
}

// The orders to doors and lifts.
Result<std::vector<Order>> ResolveBuilding(const RobotInfo& info, const ScriptCommand& command) {
  std::vector<Order> orders;
  for (const auto& [name, opening] : command.doors) {
    const Result<Order> found = ResolveDoor(info, name, opening);
    if (!found.ok()) return found.error();
    orders.push_back(found.value());
  }
  for (const auto& [name, floor] : command.lifts) {
    const Result<Order> found = ResolveLift(info, name, floor);
    if (!found.ok()) return found.error();
    orders.push_back(found.value());
  }
  return orders;
}

// The error is something that the robot or the world does not have.
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
    if (radio == info.sensors.size()) return BadInput("the robot has no radio");
    resolved.command.messages.push_back({.radio = radio, .bytes = {command.send->begin(), command.send->end()}});
  }
  for (const auto& [name, on] : command.lights) {
    const Result<Order> found = ResolveLight(info, name, on);
    if (!found.ok()) return found.error();
    resolved.command.orders.push_back(found.value());
  }
  for (const ScriptCamera& camera : command.cameras) {
    const Result<Order> found = ResolveCamera(info, camera);
    if (!found.ok()) return found.error();
    resolved.command.orders.push_back(found.value());
  }
  const Result<std::vector<Order>> of_building = ResolveBuilding(info, command);
  if (!of_building.ok()) return of_building.error();
  for (const Order& order : of_building.value()) resolved.command.orders.push_back(order);
  resolved.command.say = command.say.value_or("");
  return resolved;
}

Error InCommand(std::size_t index, const Error& error) {
  return BadInput(fmt::format("script: command {}: {}", index + 1, error.message));
}

Result<std::unique_ptr<Controller>> CreateScript(const RobotInfo& info) {
  const Result<ScriptParameters> script = ParseScript(info.parameters);
  if (!script.ok()) return script.error();
  std::vector<ResolvedCommand> commands;
  for (const ScriptCommand& command : script.value().commands) {
    Result<ResolvedCommand> resolved = Resolve(info, command);
    if (!resolved.ok()) return InCommand(commands.size(), resolved.error());
    commands.push_back(std::move(resolved).value());
  }
  return std::unique_ptr<Controller>(std::make_unique<ScriptController>(std::move(commands), script.value().period));
}

// Something that the robot or the world does not have.
Status CheckScriptInWorld(const RobotInfo& info) {
  const Result<std::unique_ptr<Controller>> script = CreateScript(info);
  return script.ok() ? Status() : script.error();
}

}  // namespace

BuiltInController Script() {
  return {"script", CheckScript, CreateScript, CheckScriptInWorld};
}

}  // namespace troupe
