#include <cmath>

#include "transport/dds/convert/convert.h"

namespace troupe::dds {
namespace {

constexpr std::int32_t kNoDomain = -1;
constexpr auto kLastCommand = static_cast<std::uint8_t>(kLastControlCommand);

troupe_wire_RobotAgent AgentToWire(const std::optional<AgentReport>& agent, WireArena& arena) {
  const AgentReport report = agent.value_or(AgentReport());
  troupe_wire_RobotAgent wire{};
  wire.known = agent.has_value();
  wire.host = arena.Copy(report.host);
  wire.pid = report.pid;
  wire.present = report.present;
  wire.answer_time = report.answer_seconds;
  wire.times_last = report.times_last;
  return wire;
}

std::optional<AgentReport> AgentFromWire(const troupe_wire_RobotAgent& wire) {
  if (!wire.known) return std::nullopt;
  return AgentReport{Text(wire.host), wire.pid, wire.present, wire.answer_time, wire.times_last};
}

constexpr double kNoPercentage = -1.0;

std::optional<double> PercentageFromWire(double value) {
  return value < 0.0 ? std::nullopt : std::optional(value);
}

Result<Goal> GoalFromWire(const troupe_wire_RobotCommand& wire) {
  Goal goal;
  goal.number = wire.goal;
  const auto x = Elements(wire.goal_x);
  const auto y = Elements(wire.goal_y);
  if (x.size() != y.size() || x.size() > kMaxWaypoints) {
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

troupe_wire_Control ToWire(const ControlRequest& message, WireArena& arena) {
  troupe_wire_Control wire{};
  wire.client = message.client;
  wire.number = message.number;
  wire.command = static_cast<std::uint8_t>(message.command);
  wire.ticks = message.ticks;
  wire.name = arena.Copy(message.name);
  wire.source = arena.Copy(message.source);
  wire.pose = PoseToWire(message.pose);
  wire.scopes = message.scopes;
  wire.rename = message.rename;
  wire.speed = message.speed.value_or(0.0);
  wire.robot_command = ToWire(message.robot_command, arena);
  wire.vx = message.twist.vx;
  wire.vy = message.twist.vy;
  wire.wz = message.twist.wz;
  wire.ros_domain = message.ros_domain ? static_cast<std::int32_t>(*message.ros_domain) : kNoDomain;
  wire.controller = arena.Copy(message.controller);
  return wire;
}

troupe_wire_ControlReply ToWire(const ControlReply& message, WireArena& arena) {
  troupe_wire_ControlReply wire{};
  wire.client = message.client;
  wire.number = message.number;
  wire.done = message.done;
  wire.problem = arena.Copy(message.problem);
  wire.state = static_cast<std::uint8_t>(message.state);
  wire.tick = message.tick;
  wire.state_hash = message.state_hash;
  wire.edition = message.edition;
  troupe_wire_Entity* out = arena.Fill(wire.entities, message.entities.size());
  for (const EntityReport& entity : message.entities) {
    *out++ = {arena.Copy(entity.name),
              arena.Copy(entity.type),
              static_cast<std::uint8_t>(entity.kind),
              PoseToWire(entity.X_WE),
              entity.twist.vx,
              entity.twist.vy,
              entity.twist.wz,
              AgentToWire(entity.agent, arena)};
  }
  return wire;
}

// Any pose and any ROS domain pass: the command decides.
Result<ControlRequest> FromWire(const troupe_wire_Control& wire) {
  ControlRequest message;
  if (wire.command > kLastCommand) {
    return Error{{},
                 "control request with command " + std::to_string(wire.command) + ", expected 0 to " +
                     std::to_string(kLastCommand)};
  }
  message.client = wire.client;
  message.number = wire.number;
  message.command = static_cast<ControlCommand>(wire.command);
  message.ticks = wire.ticks;
  message.name = Text(wire.name);
  message.source = Text(wire.source);
  message.pose = PoseFromWire(wire.pose);
  message.scopes = wire.scopes;
  message.rename = wire.rename;
  if (!(std::isfinite(wire.speed) && wire.speed >= 0.0)) {
    return Error{{}, "control request with a speed that is negative or not finite"};
  }
  if (wire.speed > 0.0) message.speed = wire.speed;
  Result<RobotCommand> command = FromWire(wire.robot_command);
  if (!command.ok()) return command.error();
  message.robot_command = std::move(command).value();
  message.twist = {wire.vx, wire.vy, wire.wz};
  if (wire.ros_domain < kNoDomain) {
    return Error{{}, "control request with the ROS domain " + std::to_string(wire.ros_domain)};
  }
  if (wire.ros_domain != kNoDomain) message.ros_domain = static_cast<std::uint32_t>(wire.ros_domain);
  message.controller = Text(wire.controller);
  return message;
}

Result<ControlReply> FromWire(const troupe_wire_ControlReply& wire) {
  ControlReply message;
  if (wire.state > static_cast<std::uint8_t>(RunState::kOver)) {
    return Error{{}, "control reply with state " + std::to_string(wire.state) + ", expected 0 to 3"};
  }
  message.client = wire.client;
  message.number = wire.number;
  message.done = wire.done;
  message.problem = Text(wire.problem);
  message.state = static_cast<RunState>(wire.state);
  message.tick = wire.tick;
  message.state_hash = wire.state_hash;
  message.edition = wire.edition;
  for (const troupe_wire_Entity& entity : Elements(wire.entities)) {
    if (entity.kind > static_cast<std::uint8_t>(EntityKind::kModel)) {
      return Error{{}, "control reply with an entity of kind " + std::to_string(entity.kind) + ", expected 0 to 2"};
    }
    message.entities.push_back({Text(entity.name),
                                Text(entity.type),
                                static_cast<EntityKind>(entity.kind),
                                PoseFromWire(entity.pose),
                                {entity.vx, entity.vy, entity.wz},
                                {},
                                AgentFromWire(entity.agent)});
  }
  return message;
}

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
