#include "common/dds/convert_frame.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace troupe::dds {
namespace {

constexpr std::uint8_t kStalledBit = 1;
constexpr std::uint8_t kLastEventType = static_cast<std::uint8_t>(EventType::kUnstable);
constexpr std::uint8_t kBlockedBit = 1;
constexpr std::uint8_t kLastObjectMode = static_cast<std::uint8_t>(ObjectMode::kHeld);
constexpr std::int32_t kNone = -1;

template <typename Id>
std::int32_t ToWire(const std::optional<Id>& id) {
  return id ? static_cast<std::int32_t>(id->index()) : kNone;
}

// REQUIRES: it is kNone or more.
template <typename Id>
std::optional<Id> FromWire(std::int32_t id) {
  if (id == kNone) return std::nullopt;
  return Id(static_cast<std::size_t>(id));
}

// Whether it is an id below `count`, or none.
bool IsIdBelow(std::int32_t id, std::size_t count) {
  return id >= kNone && (id == kNone || static_cast<std::size_t>(id) < count);
}

template <typename First, typename... Others>
bool SameLength(const First& first, const Others&... others) {
  return (... && (others.size() == first.size()));
}

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
  if (!SameLength(x, y, z, heading, vx, vy, wz, flags)) {
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

void JointsToWire(const std::vector<JointState>& joints, troupe_wire_Frame& wire, WireArena& arena) {
  double* position = arena.Fill(wire.joint_position, joints.size());
  double* velocity = arena.Fill(wire.joint_velocity, joints.size());
  std::uint8_t* flags = arena.Fill(wire.joint_flags, joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    position[i] = joints[i].position;
    velocity[i] = joints[i].velocity;
    flags[i] = joints[i].blocked ? kBlockedBit : 0;
  }
}

Status JointsFromWire(const troupe_wire_Frame& wire, std::vector<JointState>& joints) {
  const auto position = Elements(wire.joint_position);
  const auto velocity = Elements(wire.joint_velocity);
  const auto flags = Elements(wire.joint_flags);
  if (!SameLength(position, velocity, flags)) {
    return Error{{}, "frame with joint columns of different lengths, expected one row for each joint"};
  }
  joints.resize(position.size());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if ((flags[i] & ~kBlockedBit) != 0) {
      return Error{{}, "frame with joint flags " + std::to_string(flags[i]) + ", expected 0 or 1"};
    }
    if (!std::isfinite(position[i]) || !std::isfinite(velocity[i])) {
      return Error{{}, "frame with a number that is not finite for joint " + std::to_string(i)};
    }
    joints[i] = {position[i], velocity[i], flags[i] != 0};
  }
  return {};
}

void GrippersToWire(const std::vector<GripperState>& grippers, troupe_wire_Frame& wire, WireArena& arena) {
  std::int32_t* left = arena.Fill(wire.gripper_left_contact, grippers.size());
  std::int32_t* right = arena.Fill(wire.gripper_right_contact, grippers.size());
  std::int32_t* clamped = arena.Fill(wire.gripper_clamped, grippers.size());
  for (std::size_t i = 0; i < grippers.size(); ++i) {
    left[i] = ToWire(grippers[i].left_contact);
    right[i] = ToWire(grippers[i].right_contact);
    clamped[i] = ToWire(grippers[i].clamped);
  }
}

Status GrippersFromWire(const troupe_wire_Frame& wire, std::size_t objects, std::vector<GripperState>& grippers) {
  const auto left = Elements(wire.gripper_left_contact);
  const auto right = Elements(wire.gripper_right_contact);
  const auto clamped = Elements(wire.gripper_clamped);
  if (!SameLength(left, right, clamped)) {
    return Error{{}, "frame with gripper columns of different lengths, expected one row for each gripper"};
  }
  grippers.resize(left.size());
  for (std::size_t i = 0; i < grippers.size(); ++i) {
    if (left[i] < kNone || right[i] < kNone || !IsIdBelow(clamped[i], objects)) {
      return Error{{}, "frame with ids out of range for gripper " + std::to_string(i)};
    }
    grippers[i] = {FromWire<ModelId>(left[i]), FromWire<ModelId>(right[i]), FromWire<ObjectId>(clamped[i])};
  }
  return {};
}

void ObjectsToWire(const std::vector<ObjectState>& objects, troupe_wire_Frame& wire, WireArena& arena) {
  const std::size_t count = objects.size();
  double* x = arena.Fill(wire.object_x, count);
  double* y = arena.Fill(wire.object_y, count);
  double* z = arena.Fill(wire.object_z, count);
  double* heading = arena.Fill(wire.object_heading, count);
  std::uint8_t* mode = arena.Fill(wire.object_mode, count);
  double* fall_speed = arena.Fill(wire.object_fall_speed, count);
  std::int32_t* holder = arena.Fill(wire.object_holder, count);
  std::int32_t* support = arena.Fill(wire.object_support, count);
  for (std::size_t i = 0; i < count; ++i) {
    const ObjectState& object = objects[i];
    x[i] = object.X_WO.x;
    y[i] = object.X_WO.y;
    z[i] = object.X_WO.z;
    heading[i] = object.X_WO.heading;
    mode[i] = static_cast<std::uint8_t>(object.mode);
    fall_speed[i] = object.fall_speed;
    holder[i] = ToWire(object.holder);
    support[i] = ToWire(object.support);
  }
}

Status ObjectsFromWire(const troupe_wire_Frame& wire, std::size_t grippers, std::vector<ObjectState>& objects) {
  const auto x = Elements(wire.object_x);
  const auto y = Elements(wire.object_y);
  const auto z = Elements(wire.object_z);
  const auto heading = Elements(wire.object_heading);
  const auto mode = Elements(wire.object_mode);
  const auto fall_speed = Elements(wire.object_fall_speed);
  const auto holder = Elements(wire.object_holder);
  const auto support = Elements(wire.object_support);
  if (!SameLength(x, y, z, heading, mode, fall_speed, holder, support)) {
    return Error{{}, "frame with object columns of different lengths, expected one row for each object"};
  }
  objects.resize(x.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (mode[i] > kLastObjectMode) {
      return Error{{}, "frame with an object of unknown mode " + std::to_string(mode[i])};
    }
    if (!IsIdBelow(holder[i], grippers) || support[i] < kNone) {
      return Error{{}, "frame with ids out of range for object " + std::to_string(i)};
    }
    objects[i] = {{x[i], y[i], z[i], heading[i]},
                  static_cast<ObjectMode>(mode[i]),
                  fall_speed[i],
                  FromWire<GripperId>(holder[i]),
                  FromWire<ModelId>(support[i])};
    if ((objects[i].mode == ObjectMode::kHeld) != objects[i].holder.has_value()) {
      return Error{{}, "frame with object " + std::to_string(i) + " held by nobody, or by somebody but not held"};
    }
    if (!IsFinite(objects[i].X_WO) || !std::isfinite(fall_speed[i])) {
      return Error{{}, "frame with a number that is not finite for object " + std::to_string(i)};
    }
  }
  return {};
}

void EventsToWire(const std::vector<Event>& events, troupe_wire_Frame& wire, WireArena& arena) {
  const std::size_t count = events.size();
  std::uint8_t* type = arena.Fill(wire.event_type, count);
  std::int32_t* robot = arena.Fill(wire.event_robot, count);
  std::int32_t* other = arena.Fill(wire.event_other, count);
  std::int32_t* object = arena.Fill(wire.event_object, count);
  char** detail = arena.Fill(wire.event_detail, count);
  for (std::size_t i = 0; i < count; ++i) {
    const Event& event = events[i];
    type[i] = static_cast<std::uint8_t>(event.type);
    robot[i] = ToWire(event.robot);
    other[i] = ToWire(event.other);
    object[i] = ToWire(event.object);
    detail[i] = arena.Copy(event.detail);
  }
}

Status EventsFromWire(const troupe_wire_Frame& wire, std::size_t robots, std::vector<Event>& events) {
  const auto type = Elements(wire.event_type);
  const auto robot = Elements(wire.event_robot);
  const auto other = Elements(wire.event_other);
  const auto object = Elements(wire.event_object);
  const auto detail = Elements(wire.event_detail);
  const std::size_t count = type.size();
  if (!SameLength(type, robot, other, object, detail)) {
    return Error{{}, "frame with event columns of different lengths, expected one row for each event"};
  }
  events.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (type[i] > kLastEventType) return Error{{}, "frame with an event of unknown type " + std::to_string(type[i])};
    if (!IsIdBelow(robot[i], robots) || other[i] < kNone || object[i] < kNone) {
      return Error{{},
                   "frame with an event of robot " + std::to_string(robot[i]) + " and models " +
                       std::to_string(other[i]) + " and " + std::to_string(object[i]) +
                       ", expected ids of this world or -1"};
    }
    events[i].tick = wire.tick;
    events[i].type = static_cast<EventType>(type[i]);
    events[i].robot = FromWire<RobotId>(robot[i]);
    events[i].other = FromWire<ModelId>(other[i]);
    events[i].object = FromWire<ModelId>(object[i]);
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
  wire.paused = message.paused;
  wire.edition = message.edition;
  wire.world_edition = message.world_edition;
  wire.fresh_edition = message.fresh_edition;
  std::copy(message.awaited.begin(), message.awaited.end(), arena.Fill(wire.awaited, message.awaited.size()));
  RobotsToWire(message.state.robots, wire, arena);
  JointsToWire(message.state.joints, wire, arena);
  GrippersToWire(message.state.grippers, wire, arena);
  ObjectsToWire(message.state.objects, wire, arena);
  EventsToWire(message.events, wire, arena);
  return wire;
}

Status FromWire(const troupe_wire_Frame& wire, FrameMessage& message) {
  message.run = wire.run;
  message.state.tick = wire.tick;
  message.state_hash = wire.state_hash;
  message.last = wire.last;
  message.paused = wire.paused;
  message.edition = wire.edition;
  message.world_edition = wire.world_edition;
  message.fresh_edition = wire.fresh_edition;
  const auto awaited = Elements(wire.awaited);
  message.awaited.assign(awaited.begin(), awaited.end());
  WorldState& state = message.state;
  if (Status failed = RobotsFromWire(wire, state.robots)) return failed;
  if (Status failed = JointsFromWire(wire, state.joints)) return failed;
  if (Status failed = GrippersFromWire(wire, Elements(wire.object_x).size(), state.grippers)) return failed;
  if (Status failed = ObjectsFromWire(wire, state.grippers.size(), state.objects)) return failed;
  return EventsFromWire(wire, state.robots.size(), message.events);
}

}  // namespace troupe::dds
