// script: a timed list of commands.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/controller/script_parameters.h"

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
      round = static_cast<std::uint64_t>((time - in_round) / period_ + 0.5);
      time = in_round;
    }
    std::size_t due = 0;
    while (due < commands_.size() && commands_[due].at <= time) ++due;
    Command command;  // before the first command it stands still
    if (due > 0) command = commands_[due - 1].command;
    Manipulate(round * commands_.size() + due, command);
    return command;
  }

 private:
  // What grippers and joints were told stays, so they are told once: everything since the last time, in order. After a
  // late start, that is what would have been told by now.
  void Manipulate(std::uint64_t due, Command& command) {
    command.grippers.clear();
    command.joints.clear();
    const std::uint64_t count = commands_.size();
    for (std::uint64_t i = std::max(told_, due > count ? due - count : 0); i < due; ++i) {
      const Command& told = commands_[i % count].command;
      command.grippers.insert(command.grippers.end(), told.grippers.begin(), told.grippers.end());
      command.joints.insert(command.joints.end(), told.joints.begin(), told.joints.end());
    }
    told_ = due;
  }

  std::vector<ResolvedCommand> commands_;
  double period_;
  std::uint64_t told_ = 0;  // commands, in all rounds
};

std::string CheckScript(const std::string& parameters) {
  ScriptParameters ignored;
  return ParseScript(parameters, ignored);
}

// What a command asks for that the drive does not have; "" if nothing.
std::string Misfit(DriveType drive, const ScriptCommand& command) {
  switch (drive) {
    case DriveType::kCar:
      return command.for_others ? "a car is driven by 'speed' and 'steering', not by 'vx', 'vy' and 'wz'" : "";
    case DriveType::kDifferential:
      if (command.motion.twist.vy != 0.0) return "a differential drive has no 'vy'";
      [[fallthrough]];
    case DriveType::kOmni:
      return command.for_car ? "only a car is driven by 'speed' and 'steering', expected 'vx', 'vy' and 'wz'" : "";
  }
  return "";
}

// "none" or "one of: a, b"
template <typename Things, typename NameOf>
std::string Names(const Things& things, NameOf name_of) {
  std::string names;
  for (const auto& thing : things) names += (names.empty() ? "one of: " : ", ") + name_of(thing);
  return names.empty() ? "none" : names;
}

std::string ResolveGripper(const RobotInfo& info, const ScriptGripper& gripper, Command& command) {
  const auto name_of = [](const GripperInfo& g) { return g.description->name; };
  std::size_t number = 0;
  if (gripper.name.empty()) {
    if (info.grippers.empty()) return "the robot has no gripper";
    if (info.grippers.size() > 1) {
      return fmt::format("the robot has {} grippers, expected 'grippers' with {}", info.grippers.size(),
                         Names(info.grippers, name_of));
    }
  } else {
    while (number < info.grippers.size() && name_of(info.grippers[number]) != gripper.name) ++number;
    if (number == info.grippers.size()) {
      return fmt::format("unknown gripper '{}', expected {}", gripper.name, Names(info.grippers, name_of));
    }
  }
  if (gripper.lift && !info.grippers[number].lift) {
    return fmt::format("gripper '{}' has no lift", name_of(info.grippers[number]));
  }
  command.grippers.push_back({number, gripper.fingers, gripper.lift});
  return "";
}

std::string ResolveJoint(const RobotInfo& info, const ScriptJoint& wanted, Command& command) {
  for (const GripperInfo& gripper : info.grippers) {
    for (std::size_t finger : {gripper.left, gripper.right}) {
      if (info.joints[finger]->name == wanted.name) {
        return fmt::format("joint '{}' is a finger, expected 'gripper': \"open\" or \"close\"", wanted.name);
      }
    }
  }
  for (std::size_t i = 0; i < info.joints.size(); ++i) {
    const JointDescription& joint = *info.joints[i];
    if (joint.name != wanted.name) continue;
    if (wanted.position < joint.position.min || wanted.position > joint.position.max) {
      return fmt::format("joint '{}' is to go to {}, expected {} to {}", joint.name, wanted.position,
                         joint.position.min, joint.position.max);
    }
    command.joints.push_back({.joint = i, .position = wanted.position});
    return "";
  }
  return fmt::format("unknown joint '{}', expected {}", wanted.name,
                     Names(info.joints, [](const JointDescription* joint) { return joint->name; }));
}

// Fills `resolved`, or says what the robot does not have.
std::string Resolve(const RobotInfo& info, const ScriptCommand& command, ResolvedCommand& resolved) {
  resolved = {command.at, command.motion};
  std::string problem = Misfit(info.robot->drive.type, command);
  for (const ScriptGripper& gripper : command.grippers) {
    if (problem.empty()) problem = ResolveGripper(info, gripper, resolved.command);
  }
  for (const ScriptJoint& joint : command.joints) {
    if (problem.empty()) problem = ResolveJoint(info, joint, resolved.command);
  }
  return problem;
}

Result<std::unique_ptr<Controller>> CreateScript(const RobotInfo& info) {
  ScriptParameters parameters;
  if (const std::string error = ParseScript(info.parameters, parameters); !error.empty()) return Error{{}, error};
  std::vector<ResolvedCommand> commands(parameters.commands.size());
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const std::string problem = Resolve(info, parameters.commands[i], commands[i]);
    if (!problem.empty()) return Error{{}, fmt::format("script: command {}: {}", i + 1, problem)};
  }
  return std::unique_ptr<Controller>(std::make_unique<ScriptController>(std::move(commands), parameters.period));
}

}  // namespace

BuiltInController Script() {
  return {"script", CheckScript, CreateScript};
}

}  // namespace troupe
