// Checks of commands from outside (ROS, the Python interface, the viewer) before they reach a robot, and the names of
// events.
#include <cmath>

#include "common/geometry/limits.h"
#include "troupe/event.h"
#include "troupe/robot_command.h"
#include "troupe/world_description.h"

namespace troupe {
namespace {

bool IsPercentage(const std::optional<double>& value) {
  return !value || (*value >= 0.0 && *value <= 100.0);
}

bool IsInWorld(double coordinate) {
  return std::abs(coordinate) <= kMaxMagnitude;
}

Status CheckOrder(const std::vector<const GripperDescription*>& grippers, const GripperOrder& order) {
  if (order.gripper >= grippers.size()) {
    return Error{{},
                 "found a command to gripper " + std::to_string(order.gripper) + ", but it has " +
                     std::to_string(grippers.size())};
  }
  const GripperDescription& gripper = *grippers[order.gripper];
  if (order.lift && !gripper.lift) {
    return Error{{}, "found a height for gripper '" + gripper.name + "', which has no lift"};
  }
  if (!IsPercentage(order.opening) || !IsPercentage(order.lift)) {
    return Error{{}, "found an opening or a height that is out of range, expected 0 to 100 percent"};
  }
  return {};
}

Status CheckGoal(const Goal& goal) {
  if (goal.waypoints.empty() || goal.waypoints.size() > kMaxWaypoints) {
    return Error{{},
                 "found a goal with " + std::to_string(goal.waypoints.size()) + " points, expected 1 to " +
                     std::to_string(kMaxWaypoints)};
  }
  for (const Vec2& point : goal.waypoints) {
    if (!IsInWorld(point.x()) || !IsInWorld(point.y())) return Error{{}, "found a goal beyond 1000 km"};
  }
  if (!goal.heights.empty() && goal.heights.size() != goal.waypoints.size()) {
    return Error{{},
                 "found a goal with " + std::to_string(goal.heights.size()) + " heights, expected none or those of " +
                     std::to_string(goal.waypoints.size()) + " points"};
  }
  for (const double z : goal.heights) {
    if (!IsInWorld(z)) return Error{{}, "found a goal beyond 1000 km"};
  }
  if (goal.heading && !std::isfinite(*goal.heading)) return Error{{}, "found a heading that is not finite"};
  return {};
}

Status CheckMessages(const std::vector<FleetMessage>& messages) {
  if (messages.size() > kMaxFleetMessages) {
    return Error{{},
                 "found " + std::to_string(messages.size()) +
                     " messages of a fleet control in a tick, expected at most " + std::to_string(kMaxFleetMessages)};
  }
  for (const FleetMessage& message : messages) {
    if (message.text.find('\0') != std::string::npos) return Error{{}, "found a message with a byte of value 0"};
    if (!IsToVehicle(message.topic)) return Error{{}, "found a message of a vehicle, expected one to a vehicle"};
    if (message.text.size() > kMaxFleetBytes) {
      return Error{{},
                   "found a message of " + std::to_string(message.text.size()) + " bytes, expected at most " +
                       std::to_string(kMaxFleetBytes)};
    }
  }
  return {};
}

Status CheckParts(const WorldDescription& world, const RobotCommand& command) {
  if (command.twist && !IsFinite(*command.twist)) return Error{{}, "found a twist that is not finite"};
  std::vector<const GripperDescription*> grippers;
  for (const GripperDescription& gripper : world.grippers) {
    if (gripper.robot == command.robot) grippers.push_back(&gripper);
  }
  for (const GripperOrder& order : command.grippers) {
    if (Status failure = CheckOrder(grippers, order); !failure.ok()) return failure;
  }
  if (Status failure = CheckMessages(command.messages); !failure.ok()) return failure;
  return command.goal ? CheckGoal(*command.goal) : Status();
}

}  // namespace

Status CheckRobotCommand(const WorldDescription& world, const RobotCommand& command) {
  if (command.robot.index() >= world.robots.size() || !RobotExists(world, command.robot)) {
    return Error{{}, "found a command to a robot that the world does not have"};
  }
  Status failure = CheckParts(world, command);
  if (failure.ok()) return failure;
  return Error{{}, "robot " + world.robot(command.robot).name + ": " + failure.error().message};
}

}  // namespace troupe
