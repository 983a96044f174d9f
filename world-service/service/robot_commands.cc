#include "world-service/service/robot_commands.h"

#include <iterator>

namespace troupe {

void RobotCommands::Add(const RobotCommand& command, std::uint64_t ticks) {
  OfRobot& robot = robots_[command.robot];
  if (command.twist) robot.twist = Timed<Twist>{*command.twist, ticks};
  for (const GripperOrder& order : command.grippers) {
    Timed<GripperOrder>& timed = robot.grippers[order.gripper];
    GripperOrder merged = order;  // fingers and lift are told apart
    if (!merged.opening) merged.opening = timed.value.opening;
    if (!merged.lift) merged.lift = timed.value.lift;
    timed = Timed<GripperOrder>{merged, ticks};
  }
  if (command.goal) {
    robot.goal.reset();
    if (!command.goal->waypoints.empty()) {
      robot.goal = Timed<Goal>{*command.goal, ticks};
      robot.goal->value.number = ++goals_;
    }
  }
  if (robot.empty()) robots_.erase(command.robot);
}

std::vector<RobotCommand> RobotCommands::ForNextTick(const WorldDescription& world) {
  std::erase_if(robots_, [&](const auto& entry) {
    return entry.first.index() >= world.robots.size() || !IsThere(world, entry.first);
  });
  std::vector<RobotCommand> commands;
  for (auto& [robot, of_robot] : robots_) {
    RobotCommand& command = commands.emplace_back();
    command.robot = robot;
    const auto send = [](auto& timed) {
      timed.sent = true;
      return timed.value;
    };
    if (of_robot.twist) command.twist = send(*of_robot.twist);
    for (auto& [gripper, timed] : of_robot.grippers) command.grippers.push_back(send(timed));
    if (of_robot.goal) command.goal = send(*of_robot.goal);
  }
  return commands;
}

void RobotCommands::Elapse() {
  const auto expires = [](auto& timed) { return timed.sent && --timed.ticks == 0; };
  for (auto& [robot, of_robot] : robots_) {
    if (of_robot.twist && expires(*of_robot.twist)) of_robot.twist.reset();
    for (auto entry = of_robot.grippers.begin(); entry != of_robot.grippers.end();) {
      entry = expires(entry->second) ? of_robot.grippers.erase(entry) : std::next(entry);
    }
    if (of_robot.goal && expires(*of_robot.goal)) of_robot.goal.reset();
  }
  std::erase_if(robots_, [](const auto& entry) { return entry.second.empty(); });
}

}  // namespace troupe
