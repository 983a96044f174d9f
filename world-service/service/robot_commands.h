// RobotCommands: the commands to robots from outside of the simulation (tools, viewers), each in force for a number of
// ticks. A command replaces the one before of the same kind: motion, each gripper, goal.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "troupe/robot_command.h"
#include "troupe/world_description.h"

namespace troupe {

// A part of a command that is in force. Beside the class, because clang 14 cannot compile it inside.
template <typename Value>
struct Timed {
  Value value;
  std::uint64_t ticks = 0;  // left
  bool sent = false;        // to the agents, for the next tick
};

class RobotCommands {
 public:
  // Goals are numbered from the one after `last_goal` on: the robots of a run that is continued know other numbers.
  explicit RobotCommands(std::uint32_t last_goal = 0) : goals_(last_goal) {}

  // For the next `ticks` ticks. A goal without waypoints cancels the goal.
  // REQUIRES: CheckRobotCommand succeeded, but for that.
  void Add(const RobotCommand& command, std::uint64_t ticks);

  // Those for the next tick, in robot-id order, of robots that the world has.
  std::vector<RobotCommand> ForNextTick(const WorldDescription& world);
  // The tick for which ForNextTick was called last was stepped.
  void Elapse();

  void Clear() { robots_.clear(); }

 private:
  struct OfRobot {
    std::optional<Timed<Twist>> twist;
    std::map<std::size_t, Timed<GripperOrder>> grippers;
    std::optional<Timed<Goal>> goal;
    bool empty() const { return !twist && grippers.empty() && !goal; }
  };
  std::map<RobotId, OfRobot> robots_;
  std::uint32_t goals_;  // numbers them
};

}  // namespace troupe
