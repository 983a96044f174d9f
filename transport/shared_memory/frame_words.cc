#include "transport/shared_memory/frame_words.h"

#include <utility>

namespace troupe {
namespace {

constexpr std::uint64_t kLast = 1;
constexpr std::uint64_t kPaused = 2;
constexpr std::uint64_t kRemembered = 4;
constexpr std::uint64_t kDrives = 1;  // of a command, like the next two
constexpr std::uint64_t kHasGoal = 2;
constexpr std::uint64_t kHasHeading = 4;
constexpr std::uint64_t kAnyId = std::uint64_t{1} << 31;
constexpr std::size_t kLongestDetail = 1'000'000;  // bytes, of an event
constexpr auto kLastEvent = static_cast<std::uint64_t>(kLastEventType);
constexpr auto kLastObjectMode = static_cast<std::uint64_t>(ObjectMode::kHeld);

// Words of a row.
constexpr std::size_t kRobotWords = 8;
constexpr std::size_t kJointWords = 3;
constexpr std::size_t kGripperWords = 3;
constexpr std::size_t kObjectWords = 8;
constexpr std::size_t kEventWords = 5;         // and its detail
constexpr std::size_t kTransmissionWords = 7;  // and its bytes
constexpr std::size_t kStoreWords = 2;
constexpr std::size_t kImuWords = 3;
constexpr std::size_t kLightWords = 1;
constexpr std::size_t kCameraWords = 2;
constexpr std::size_t kOtherWords = 20;   // of a frame: eight numbers and twelve counts
constexpr std::size_t kCommandWords = 9;  // without gripper orders and waypoints
constexpr std::size_t kOrderWords = 3;
constexpr std::size_t kWaypointWords = 2;

void Add(const Pose& pose, WordWriter& words) {
  words.Add(pose.x);
  words.Add(pose.y);
  words.Add(pose.z);
  words.Add(pose.heading);
}

void AddState(const WorldState& state, WordWriter& words) {
  words.Add(state.robots.size());
  for (const RobotState& robot : state.robots) {
    Add(robot.X_WR, words);
    words.Add(robot.twist.vx);
    words.Add(robot.twist.vy);
    words.Add(robot.twist.wz);
    words.Add(std::uint64_t{robot.stalled});
  }
  words.Add(state.joints.size());
  for (const JointState& joint : state.joints) {
    words.Add(joint.position);
    words.Add(joint.velocity);
    words.Add(std::uint64_t{joint.blocked});
  }
  words.Add(state.grippers.size());
  for (const GripperState& gripper : state.grippers) {
    words.Add(gripper.left_contact);
    words.Add(gripper.right_contact);
    words.Add(gripper.clamped);
  }
  words.Add(state.objects.size());
  for (const ObjectState& object : state.objects) {
    Add(object.X_WO, words);
    words.Add(static_cast<std::uint64_t>(object.mode));
    words.Add(object.fall_speed);
    words.Add(object.holder);
    words.Add(object.support);
  }
  words.Add(state.stores.size());
  for (const StoreState& store : state.stores) {
    words.Add(store.joules);
    words.Add(store.charge_watts);
  }
  words.Add(state.imus.size());
  for (const ImuState& imu : state.imus) {
    words.Add(imu.vx);
    words.Add(imu.vy);
    words.Add(imu.vz);
  }
  words.Add(state.lights.size());
  for (const LightState& light : state.lights) words.Add(std::uint64_t{light.is_switched_on});
  words.Add(state.cameras.size());
  for (const CameraState& camera : state.cameras) {
    words.Add(camera.pan);
    words.Add(camera.tilt);
  }
  words.Add(state.transmissions.size());
  for (const RadioTransmission& transmission : state.transmissions) {
    words.Add(std::uint64_t{transmission.from.index()});
    words.Add(transmission.sent);
    words.Add(transmission.due);
    words.Add(std::uint64_t{transmission.number});
    words.Add(std::uint64_t{transmission.message.radio});
    words.Add(transmission.message.to);
    words.Add(transmission.message.bytes);
  }
}

bool Read(WordReader& words, Pose& pose) {
  return words.ReadFinite(pose.x) && words.ReadFinite(pose.y) && words.ReadFinite(pose.z) &&
         words.ReadFinite(pose.heading);
}

bool Read(WordReader& words, RobotState& robot) {
  return Read(words, robot.X_WR) && words.ReadFinite(robot.twist.vx) && words.ReadFinite(robot.twist.vy) &&
         words.ReadFinite(robot.twist.wz) && words.Read(robot.stalled);
}

bool Read(WordReader& words, JointState& joint) {
  return words.ReadFinite(joint.position) && words.ReadFinite(joint.velocity) && words.Read(joint.blocked);
}

// `objects` of the world.
bool Read(WordReader& words, GripperState& gripper, std::size_t objects) {
  return words.Read(gripper.left_contact, kAnyId) && words.Read(gripper.right_contact, kAnyId) &&
         words.Read(gripper.clamped, objects);
}

bool Read(WordReader& words, ObjectState& object, std::size_t grippers) {
  std::uint64_t mode = 0;
  if (!Read(words, object.X_WO) || !words.Read(mode) || mode > kLastObjectMode) return false;
  object.mode = static_cast<ObjectMode>(mode);
  if (!words.ReadFinite(object.fall_speed) || !words.Read(object.holder, grippers)) return false;
  return words.Read(object.support, kAnyId) && (object.mode == ObjectMode::kHeld) == object.holder.has_value();
}

bool Read(WordReader& words, RadioTransmission& transmission, std::size_t robots) {
  std::uint64_t from = 0;
  std::uint64_t number = 0;
  std::uint64_t radio = 0;
  if (!words.Read(from) || from >= robots || !words.Read(transmission.sent) || !words.Read(transmission.due) ||
      !words.Read(number) || !words.Read(radio) || radio >= kAnyId) {
    return false;
  }
  transmission.from = RobotId(static_cast<std::size_t>(from));
  transmission.number = static_cast<std::size_t>(number);
  transmission.message.radio = static_cast<std::size_t>(radio);
  return words.Read(transmission.message.to, robots) && words.Read(transmission.message.bytes, kMostRadioBytes);
}

bool ReadState(WordReader& words, WorldState& state) {
  std::size_t count = 0;
  if (!words.ReadCount(count, kRobotWords)) return false;
  state.robots.resize(count);
  for (RobotState& robot : state.robots) {
    if (!Read(words, robot)) return false;
  }
  if (!words.ReadCount(count, kJointWords)) return false;
  state.joints.resize(count);
  for (JointState& joint : state.joints) {
    if (!Read(words, joint)) return false;
  }
  if (!words.ReadCount(count, kGripperWords)) return false;
  state.grippers.resize(count);
  // Grippers refer to objects, whose number follows them.
  for (GripperState& gripper : state.grippers) {
    if (!Read(words, gripper, kAnyId)) return false;
  }
  if (!words.ReadCount(count, kObjectWords)) return false;
  state.objects.resize(count);
  for (ObjectState& object : state.objects) {
    if (!Read(words, object, state.grippers.size())) return false;
  }
  for (const GripperState& gripper : state.grippers) {
    if (gripper.clamped && gripper.clamped->index() >= count) return false;
  }
  if (!words.ReadCount(count, kStoreWords)) return false;
  state.stores.resize(count);
  for (StoreState& store : state.stores) {
    if (!words.ReadFinite(store.joules) || !words.ReadFinite(store.charge_watts)) return false;
  }
  if (!words.ReadCount(count, kImuWords)) return false;
  state.imus.resize(count);
  for (ImuState& imu : state.imus) {
    if (!words.ReadFinite(imu.vx) || !words.ReadFinite(imu.vy) || !words.ReadFinite(imu.vz)) return false;
  }
  if (!words.ReadCount(count, kLightWords)) return false;
  state.lights.resize(count);
  for (LightState& light : state.lights) {
    if (!words.Read(light.is_switched_on)) return false;
  }
  if (!words.ReadCount(count, kCameraWords)) return false;
  state.cameras.resize(count);
  for (CameraState& camera : state.cameras) {
    if (!words.ReadFinite(camera.pan) || !words.ReadFinite(camera.tilt)) return false;
  }
  if (!words.ReadCount(count, kTransmissionWords)) return false;
  state.transmissions.resize(count);
  for (RadioTransmission& transmission : state.transmissions) {
    if (!Read(words, transmission, state.robots.size())) return false;
  }
  return true;
}

void AddEvent(const Event& event, WordWriter& words) {
  words.Add(static_cast<std::uint64_t>(event.type));
  words.Add(event.robot);
  words.Add(event.other);
  words.Add(event.object);
  words.Add(event.detail);
}

bool ReadEvent(WordReader& words, Event& event, std::size_t robots) {
  std::uint64_t type = 0;
  if (!words.Read(type) || type > kLastEvent) return false;
  event.type = static_cast<EventType>(type);
  return words.Read(event.robot, robots) && words.Read(event.other, kAnyId) && words.Read(event.object, kAnyId) &&
         words.Read(event.detail, kLongestDetail);
}

// Percentages of a gripper's order; negative: none.
constexpr double kNoPercentage = -1.0;

bool Read(WordReader& words, std::optional<double>& percentage) {
  double value = 0.0;
  if (!words.ReadFinite(value) || value > 100.0) return false;
  percentage = value < 0.0 ? std::nullopt : std::optional(value);
  return true;
}

// Always kCommandWords, then the orders and the waypoints.
void AddCommand(const RobotCommand& command, WordWriter& words) {
  const Twist twist = command.twist.value_or(Twist{});
  const Goal goal = command.goal.value_or(Goal{});
  words.Add(static_cast<std::uint64_t>(command.robot.index()));
  words.Add((command.twist ? kDrives : 0) | (command.goal ? kHasGoal : 0) | (goal.heading ? kHasHeading : 0));
  words.Add(twist.vx);
  words.Add(twist.vy);
  words.Add(twist.wz);
  words.Add(std::uint64_t{goal.number});
  words.Add(goal.heading.value_or(0.0));
  words.Add(command.grippers.size());
  for (const GripperOrder& order : command.grippers) {
    words.Add(static_cast<std::uint64_t>(order.gripper));
    words.Add(order.opening.value_or(kNoPercentage));
    words.Add(order.lift.value_or(kNoPercentage));
  }
  words.Add(goal.waypoints.size());
  for (const Vec2& point : goal.waypoints) {
    words.Add(point.x());
    words.Add(point.y());
  }
}

bool ReadCommand(WordReader& words, RobotCommand& command) {
  std::uint64_t robot = 0;
  std::uint64_t flags = 0;
  std::uint64_t number = 0;
  Twist twist;
  Goal goal;
  double heading = 0.0;
  std::size_t count = 0;
  if (!words.Read(robot) || robot >= kAnyId || !words.Read(flags) || !words.ReadFinite(twist.vx) ||
      !words.ReadFinite(twist.vy) || !words.ReadFinite(twist.wz) || !words.Read(number) || !words.ReadFinite(heading) ||
      !words.ReadCount(count, kOrderWords)) {
    return false;
  }
  command.robot = RobotId(static_cast<std::size_t>(robot));
  command.twist = (flags & kDrives) != 0 ? std::optional(twist) : std::nullopt;
  command.grippers.resize(count);
  for (GripperOrder& order : command.grippers) {
    std::uint64_t gripper = 0;
    if (!words.Read(gripper) || gripper >= kAnyId || !Read(words, order.opening) || !Read(words, order.lift)) {
      return false;
    }
    order.gripper = static_cast<std::size_t>(gripper);
  }
  if (!words.ReadCount(count, kWaypointWords) || count > kMostWaypoints) return false;
  for (std::size_t i = 0; i < count; ++i) {
    double x = 0.0;
    double y = 0.0;
    if (!words.ReadFinite(x) || !words.ReadFinite(y)) return false;
    goal.waypoints.emplace_back(x, y);
  }
  goal.number = static_cast<std::uint32_t>(number);
  if ((flags & kHasHeading) != 0) goal.heading = heading;
  command.goal.reset();
  if ((flags & kHasGoal) != 0) command.goal = std::move(goal);
  return true;
}

bool ReadAll(WordReader& words, FrameMessage& frame) {
  std::uint64_t flags = 0;
  std::uint64_t edition = 0;
  std::uint64_t world_edition = 0;
  std::uint64_t fresh_edition = 0;
  std::uint64_t incarnation = 0;
  if (!words.Read(frame.run) || !words.Read(frame.state.tick) || !words.Read(frame.state_hash) || !words.Read(flags) ||
      !words.Read(edition) || !words.Read(world_edition) || !words.Read(fresh_edition) || !words.Read(incarnation)) {
    return false;
  }
  frame.last = (flags & kLast) != 0;
  frame.paused = (flags & kPaused) != 0;
  frame.remembered = (flags & kRemembered) != 0;
  frame.edition = static_cast<Edition>(edition);
  frame.world_edition = static_cast<Edition>(world_edition);
  frame.fresh_edition = static_cast<Edition>(fresh_edition);
  frame.incarnation = static_cast<Incarnation>(incarnation);
  if (!ReadState(words, frame.state)) return false;
  std::size_t count = 0;
  if (!words.ReadCount(count, 1)) return false;
  frame.awaited.resize(count);
  for (AgentId& agent : frame.awaited) {
    if (!words.Read(agent)) return false;
  }
  if (!words.ReadCount(count, kEventWords)) return false;
  frame.events.resize(count);
  for (Event& event : frame.events) {
    event.tick = frame.state.tick;
    if (!ReadEvent(words, event, frame.state.robots.size())) return false;
  }
  if (!words.ReadCount(count, kCommandWords)) return false;
  frame.commands.resize(count);
  std::uint64_t next = 0;  // the least id that may follow
  for (RobotCommand& command : frame.commands) {
    if (!ReadCommand(words, command) || command.robot.index() < next) return false;
    if (command.robot.index() >= frame.state.robots.size()) return false;
    next = command.robot.index() + 1;
  }
  return words.remaining() == 0;
}

}  // namespace

void AddFrame(const FrameMessage& frame, WordWriter& words) {
  words.Add(frame.run);
  words.Add(frame.state.tick);
  words.Add(frame.state_hash);
  words.Add((frame.last ? kLast : 0) | (frame.paused ? kPaused : 0) | (frame.remembered ? kRemembered : 0));
  words.Add(std::uint64_t{frame.edition});
  words.Add(std::uint64_t{frame.world_edition});
  words.Add(std::uint64_t{frame.fresh_edition});
  words.Add(std::uint64_t{frame.incarnation});
  AddState(frame.state, words);
  words.Add(frame.awaited.size());
  for (const AgentId agent : frame.awaited) words.Add(agent);
  words.Add(frame.events.size());
  for (const Event& event : frame.events) AddEvent(event, words);
  words.Add(frame.commands.size());
  for (const RobotCommand& command : frame.commands) AddCommand(command, words);
}

std::size_t CountFrameWords(const FrameMessage& frame) {
  const WorldState& state = frame.state;
  std::size_t count = kOtherWords + kRobotWords * state.robots.size() + kJointWords * state.joints.size() +
                      kGripperWords * state.grippers.size() + kObjectWords * state.objects.size() +
                      kStoreWords * state.stores.size() + kImuWords * state.imus.size() +
                      kLightWords * state.lights.size() + kCameraWords * state.cameras.size() + frame.awaited.size() +
                      kEventWords * frame.events.size();
  for (const RadioTransmission& transmission : state.transmissions) {
    count += kTransmissionWords + (transmission.message.bytes.size() + sizeof(Word) - 1) / sizeof(Word);
  }
  for (const Event& event : frame.events) count += (event.detail.size() + sizeof(Word) - 1) / sizeof(Word);
  for (const RobotCommand& command : frame.commands) {
    count += kCommandWords + kOrderWords * command.grippers.size() +
             kWaypointWords * (command.goal ? command.goal->waypoints.size() : 0);
  }
  return count;
}

Status ReadFrame(WordReader words, FrameMessage& frame) {
  if (ReadAll(words, frame)) return {};
  return Error{{}, "a frame in shared memory with a value that is not finite, not known, or missing"};
}

}  // namespace troupe
