#include "common/dds/convert_frame.h"

namespace troupe::dds {
namespace {

constexpr std::uint8_t kStalledBit = 1;
constexpr std::uint8_t kLastEventType = static_cast<std::uint8_t>(EventType::kProposalRejected);
constexpr std::int32_t kNone = -1;

void RobotsToWire(const std::vector<RobotState>& robots, troupe_wire_Frame& wire, WireArena& arena) {
  const std::size_t count = robots.size();
  double* x = arena.Fill(wire.x, count);
  double* y = arena.Fill(wire.y, count);
  double* z = arena.Fill(wire.z, count);
  double* heading = arena.Fill(wire.heading, count);
  double* vx = arena.Fill(wire.vx, count);
  double* vy = arena.Fill(wire.vy, count);
  double* wz = arena.Fill(wire.wz, count);
  std::uint8_t* flags = arena.Fill(wire.flags, count);
  for (std::size_t i = 0; i < count; ++i) {
    const RobotState& robot = robots[i];
    x[i] = robot.X_WR.x;
    y[i] = robot.X_WR.y;
    z[i] = robot.X_WR.z;
    heading[i] = robot.X_WR.heading;
    vx[i] = robot.twist.vx;
    vy[i] = robot.twist.vy;
    wz[i] = robot.twist.wz;
    flags[i] = robot.stalled ? kStalledBit : 0;
  }
}

Status RobotsFromWire(const troupe_wire_Frame& wire, std::vector<RobotState>& robots) {
  const auto x = Elements(wire.x);
  const auto y = Elements(wire.y);
  const auto z = Elements(wire.z);
  const auto heading = Elements(wire.heading);
  const auto vx = Elements(wire.vx);
  const auto vy = Elements(wire.vy);
  const auto wz = Elements(wire.wz);
  const auto flags = Elements(wire.flags);
  const std::size_t count = x.size();
  if (y.size() != count || z.size() != count || heading.size() != count || vx.size() != count || vy.size() != count ||
      wz.size() != count || flags.size() != count) {
    return Error{{}, "frame with columns of different lengths, expected one row for each robot"};
  }
  robots.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if ((flags[i] & ~kStalledBit) != 0) {
      return Error{{}, "frame with robot flags " + std::to_string(flags[i]) + ", expected 0 or 1"};
    }
    robots[i] = {{x[i], y[i], z[i], heading[i]}, {vx[i], vy[i], wz[i]}, flags[i] != 0};
    if (!IsFinite(robots[i].X_WR) || !IsFinite(robots[i].twist)) {
      return Error{{}, "frame with a number that is not finite for robot " + std::to_string(i)};
    }
  }
  return {};
}

void EventsToWire(const std::vector<Event>& events, troupe_wire_Frame& wire, WireArena& arena) {
  const std::size_t count = events.size();
  std::uint8_t* type = arena.Fill(wire.event_type, count);
  std::int32_t* robot = arena.Fill(wire.event_robot, count);
  std::int32_t* other = arena.Fill(wire.event_other, count);
  char** detail = arena.Fill(wire.event_detail, count);
  for (std::size_t i = 0; i < count; ++i) {
    const Event& event = events[i];
    type[i] = static_cast<std::uint8_t>(event.type);
    robot[i] = event.robot ? static_cast<std::int32_t>(event.robot->index()) : kNone;
    other[i] = event.other ? static_cast<std::int32_t>(event.other->index()) : kNone;
    detail[i] = arena.Copy(event.detail);
  }
}

Status EventsFromWire(const troupe_wire_Frame& wire, std::size_t robots, std::vector<Event>& events) {
  const auto type = Elements(wire.event_type);
  const auto robot = Elements(wire.event_robot);
  const auto other = Elements(wire.event_other);
  const auto detail = Elements(wire.event_detail);
  const std::size_t count = type.size();
  if (robot.size() != count || other.size() != count || detail.size() != count) {
    return Error{{}, "frame with event columns of different lengths, expected one row for each event"};
  }
  events.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (type[i] > kLastEventType) return Error{{}, "frame with an event of unknown type " + std::to_string(type[i])};
    if (robot[i] < kNone || (robot[i] >= 0 && static_cast<std::size_t>(robot[i]) >= robots) || other[i] < kNone) {
      return Error{{},
                   "frame with an event of robot " + std::to_string(robot[i]) + " and model " +
                       std::to_string(other[i]) + ", expected ids of this world or -1"};
    }
    events[i].tick = wire.tick;
    events[i].type = static_cast<EventType>(type[i]);
    events[i].robot = robot[i] == kNone ? std::nullopt : std::optional(RobotId(static_cast<std::size_t>(robot[i])));
    events[i].other = other[i] == kNone ? std::nullopt : std::optional(ModelId(static_cast<std::size_t>(other[i])));
    events[i].detail = Text(detail[i]);
  }
  return {};
}

}  // namespace

troupe_wire_Frame ToWire(const FrameMessage& message, WireArena& arena) {
  troupe_wire_Frame wire{};
  wire.run = message.run;
  wire.tick = message.state.tick;
  wire.state_hash = message.state_hash;
  wire.last = message.last;
  RobotsToWire(message.state.robots, wire, arena);
  EventsToWire(message.events, wire, arena);
  return wire;
}

Status FromWire(const troupe_wire_Frame& wire, FrameMessage& message) {
  message.run = wire.run;
  message.state.tick = wire.tick;
  message.state_hash = wire.state_hash;
  message.last = wire.last;
  if (Status failed = RobotsFromWire(wire, message.state.robots)) return failed;
  return EventsFromWire(wire, message.state.robots.size(), message.events);
}

}  // namespace troupe::dds
