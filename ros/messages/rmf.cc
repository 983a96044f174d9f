#include "ros/messages/rmf.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/base/json_reader.h"

namespace troupe::ros {

// At the first tick of each period of simulated time, whatever the length of a tick.
bool IsDue(Tick tick, std::int64_t interval_ns, double period_seconds) {
  const auto period_ns = static_cast<std::int64_t>(std::llround(period_seconds * 1e9));
  const auto time_ns = static_cast<std::int64_t>(tick) * interval_ns;
  return tick == 0 || time_ns / period_ns != (time_ns - interval_ns) / period_ns;
}

// Worlds without doors, lifts and slotcars have no topics of Open-RMF.
bool HasRmf(const WorldDescription& world) {
  return !world.doors.empty() || !world.lifts.empty() ||
         std::any_of(world.robots.begin(), world.robots.end(),
                     [](const RobotDescription& robot) { return robot.controller.name == kPathController; });
}

std::optional<std::string> TagAfter(const NamedPlace& place, const std::string& prefix) {
  for (const std::string& tag : place.tags) {
    if (tag.starts_with(prefix)) return tag.substr(prefix.size());
  }
  return std::nullopt;
}

// The controller's parameter, else the tag of the robot's place in a building, else the robot's type.
std::string FleetOf(const WorldDescription& world, RobotId robot) {
  const RobotDescription& description = world.robot(robot);
  if (description.controller.name == kPathController) {
    const JsonReader parameters = JsonReader::OfText(description.controller.parameters);
    if (const auto fleet = parameters.Optional<std::string>("fleet")) return *fleet;
  }
  for (const NamedPlace& place : world.places) {
    if (TagAfter(place, "robot:") != description.name) continue;
    if (std::optional<std::string> fleet = TagAfter(place, "fleet:")) return *fleet;
  }
  return world.model(description.root).type;
}

// Doors of a lift follow the lift: Open-RMF has no requests for them.
std::vector<std::size_t> DoorsOf(const WorldDescription& world) {
  std::vector<bool> is_of_lift(world.doors.size(), false);
  for (const LiftDescription& lift : world.lifts) {
    for (const LiftFloor& floor : lift.floors) {
      for (const std::size_t door : floor.doors) is_of_lift[door] = true;
    }
  }
  std::vector<std::size_t> doors;
  for (std::size_t i = 0; i < world.doors.size(); ++i) {
    if (world.doors[i].is_operated && !is_of_lift[i]) doors.push_back(i);
  }
  return doors;
}

std::string LevelAt(const WorldDescription& world, double z) {
  return troupe::LevelAt(world.levels, z);
}

DoorMode ModeOf(const DoorState& door) {
  return door.opening <= 0.0 ? DoorMode::kClosed : door.opening >= 1.0 ? DoorMode::kOpen : DoorMode::kMoving;
}

DoorStateMessage MakeDoorState(const Time& stamp, const std::string& name, const DoorState& door,
                               dds::WireArena& arena) {
  return {stamp, arena.Copy(name), {static_cast<std::uint32_t>(ModeOf(door))}};
}

// The nearest floor, also while the cabin is between two.
std::size_t FloorOf(const LiftDescription& lift, const LiftState& state) {
  const auto nearest = std::min_element(
      lift.floors.begin(), lift.floors.end(),
      [&](const LiftFloor& a, const LiftFloor& b) { return std::fabs(a.z - state.z) < std::fabs(b.z - state.z); });
  return static_cast<std::size_t>(nearest - lift.floors.begin());
}

// All doors of a floor as one: open or closed only if all are.
DoorMode DoorsAt(const LiftDescription& lift, const WorldState& state, std::size_t floor) {
  bool is_open = true;
  bool is_closed = true;
  for (const std::size_t door : lift.floors[floor].doors) {
    const DoorMode mode = ModeOf(state.doors[door]);
    is_open = is_open && mode == DoorMode::kOpen;
    is_closed = is_closed && mode == DoorMode::kClosed;
  }
  return is_open ? DoorMode::kOpen : is_closed ? DoorMode::kClosed : DoorMode::kMoving;
}

// The two modes are those in which a lift adapter and people use it; Troupe's lifts know no others.
LiftStateMessage MakeLiftState(const Time& stamp, const WorldDescription& world, std::size_t lift,
                               const WorldState& state, LiftMode mode, const std::string& session,
                               dds::WireArena& arena) {
  const LiftDescription& description = world.lifts[lift];
  const LiftState& now = state.lifts[lift];
  const double way = description.floors[now.floor].z - now.z;
  const LiftMotion motion = way > 0.0 ? LiftMotion::kUp : way < 0.0 ? LiftMotion::kDown : LiftMotion::kStopped;
  const std::size_t floor = FloorOf(description, now);
  LiftStateMessage message{};
  message.lift_time = stamp;
  message.lift_name = arena.Copy(world.model(description.model).name);
  char** name = arena.Fill(message.available_floors, description.floors.size());
  for (const LiftFloor& each : description.floors) *name++ = arena.Copy(each.name);
  message.current_floor = arena.Copy(description.floors[floor].name);
  message.destination_floor = arena.Copy(description.floors[now.floor].name);
  message.door_state = static_cast<std::uint8_t>(DoorsAt(description, state, floor));
  message.motion_state = static_cast<std::uint8_t>(motion);
  std::uint8_t* modes = arena.Fill(message.available_modes, 2);
  modes[0] = static_cast<std::uint8_t>(LiftMode::kHuman);
  modes[1] = static_cast<std::uint8_t>(LiftMode::kAgv);
  message.current_mode = static_cast<std::uint8_t>(mode);
  message.session_id = arena.Copy(session);
  return message;
}

RmfLocation FromMessage(const LocationMessage& message) {
  return {message.t,
          message.x,
          message.y,
          message.yaw,
          message.obey_approach_speed_limit,
          message.approach_speed_limit,
          dds::Text(message.level_name),
          message.index};
}

LocationMessage ToMessage(const RmfLocation& location, dds::WireArena& arena) {
  return {location.time,
          location.x,
          location.y,
          location.yaw,
          location.obeys_speed_limit,
          location.speed_limit,
          arena.Copy(location.level),
          location.index};
}

}  // namespace troupe::ros
