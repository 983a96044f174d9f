#include "transport/dds/convert/convert_robot_command.h"

#include <cmath>

namespace troupe::dds {
namespace {

constexpr double kNoPercentage = -1.0;

std::optional<double> PercentageFromWire(double value) {
  return value < 0.0 ? std::nullopt : std::optional(value);
}

Result<Goal> GoalFromWire(const troupe_wire_RobotCommand& wire) {
  Goal goal;
  goal.number = wire.goal;
  const auto x = Elements(wire.goal_x);
  const auto y = Elements(wire.goal_y);
  if (x.size() != y.size() || x.size() > kMostWaypoints) {
    return Error{{}, "command of a robot with goal columns of different lengths, or too long"};
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i]))
      return Error{{}, "command of a robot to a goal that is not finite"};
    goal.waypoints.emplace_back(x[i], y[i]);
  }
  if (wire.has_goal_heading) {
    if (!std::isfinite(wire.goal_heading)) return Error{{}, "command of a robot to a heading that is not finite"};
    goal.heading = wire.goal_heading;
  }
  return goal;
}

}  // namespace

troupe_wire_RobotCommand ToWire(const RobotCommand& command, WireArena& arena) {
  troupe_wire_RobotCommand wire{};
  wire.robot = static_cast<std::uint32_t>(command.robot.index());
  wire.drives = command.twist.has_value();
  const Twist twist = command.twist.value_or(Twist{});
  wire.vx = twist.vx;
  wire.vy = twist.vy;
  wire.wz = twist.wz;
  troupe_wire_GripperOrder* out = arena.Fill(wire.grippers, command.grippers.size());
  for (const GripperOrder& order : command.grippers) {
    *out++ = {static_cast<std::uint32_t>(order.gripper), order.opening.value_or(kNoPercentage),
              order.lift.value_or(kNoPercentage)};
  }
  wire.has_goal = command.goal.has_value();
  if (!command.goal) return wire;
  wire.goal = command.goal->number;
  double* x = arena.Fill(wire.goal_x, command.goal->waypoints.size());
  double* y = arena.Fill(wire.goal_y, command.goal->waypoints.size());
  for (const Vec2& point : command.goal->waypoints) {
    *x++ = point.x();
    *y++ = point.y();
  }
  wire.has_goal_heading = command.goal->heading.has_value();
  wire.goal_heading = command.goal->heading.value_or(0.0);
  return wire;
}

Result<RobotCommand> FromWire(const troupe_wire_RobotCommand& wire) {
  RobotCommand command;
  command.robot = RobotId(wire.robot);
  if (wire.drives) {
    command.twist = {wire.vx, wire.vy, wire.wz};
    if (!IsFinite(*command.twist)) return Error{{}, "command of a robot with a twist that is not finite"};
  }
  for (const troupe_wire_GripperOrder& order : Elements(wire.grippers)) {
    if (!(order.opening <= 100.0 && order.lift <= 100.0)) {
      return Error{{}, "command of a gripper beyond 100 percent, or not a number"};
    }
    command.grippers.push_back({order.gripper, PercentageFromWire(order.opening), PercentageFromWire(order.lift)});
  }
  if (wire.has_goal) {
    Result<Goal> goal = GoalFromWire(wire);
    if (!goal.ok()) return goal.error();
    command.goal = std::move(goal).value();
  }
  return command;
}

}  // namespace troupe::dds
