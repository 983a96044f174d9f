// Open-RMF's messages from values of the simulation, and what it calls the parts of a world: pure functions. Frames and
// units of its messages are those of the world; the strings and sequences live in the arena.
// Layouts of Kilted differ in types of fields only; one value (RmfRobot) is written in either.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "idl/ros/building_map.h"
#include "idl/ros/kilted.h"
#include "idl/ros/rmf.h"
#include "ros/messages/messages.h"
#include "transport/dds/binding/wire.h"
#include "troupe/pose.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe::ros {

using DoorRequest = rmf_door_msgs_msg_dds__DoorRequest_;
using DoorStateMessage = rmf_door_msgs_msg_dds__DoorState_;
using LiftRequest = rmf_lift_msgs_msg_dds__LiftRequest_;
using LiftStateMessage = rmf_lift_msgs_msg_dds__LiftState_;
using DispenserRequest = rmf_dispenser_msgs_msg_dds__DispenserRequest_;
using DispenserResult = rmf_dispenser_msgs_msg_dds__DispenserResult_;
using DispenserStateMessage = rmf_dispenser_msgs_msg_dds__DispenserState_;
using IngestorRequest = rmf_ingestor_msgs_msg_dds__IngestorRequest_;
using IngestorResult = rmf_ingestor_msgs_msg_dds__IngestorResult_;
using IngestorStateMessage = rmf_ingestor_msgs_msg_dds__IngestorState_;
using LocationMessage = rmf_fleet_msgs_msg_dds__Location_;
using PathRequest = rmf_fleet_msgs_msg_dds__PathRequest_;
using PauseRequest = rmf_fleet_msgs_msg_dds__PauseRequest_;
// In the layouts up to Jazzy, and from Kilted on.
using ModeRequest = rmf_fleet_msgs_msg_dds__ModeRequest_;
using LaterModeRequest = kilted_rmf_fleet_msgs_msg_dds__ModeRequest_;
using RobotStateMessage = rmf_fleet_msgs_msg_dds__RobotState_;
using LaterRobotStateMessage = kilted_rmf_fleet_msgs_msg_dds__RobotState_;
using FleetStateMessage = rmf_fleet_msgs_msg_dds__FleetState_;
using LaterFleetStateMessage = kilted_rmf_fleet_msgs_msg_dds__FleetState_;

// Values of the messages.
enum class DoorMode : std::uint8_t { kClosed = 0, kMoving = 1, kOpen = 2 };
enum class LiftMotion : std::uint8_t { kStopped = 0, kUp = 1, kDown = 2 };
enum class LiftRequestType : std::uint8_t { kEndSession = 0, kAgv = 1, kHuman = 2 };
enum class LiftMode : std::uint8_t { kHuman = 1, kAgv = 2 };

// How often states are written that stay as they are, s of simulated time, as by Open-RMF's plugins for Gazebo.
inline constexpr double kRobotStatePeriod = 0.5;
inline constexpr double kDoorStatePeriod = 1.0;
inline constexpr double kWorkcellStatePeriod = 2.0;

// True at the first tick, and at each that begins another period.
bool IsDue(Tick tick, std::int64_t interval_ns, double period_seconds);

// The built-in controller whose robots drive along the paths of Open-RMF.
inline constexpr const char* kPathController = "slotcar";

// Whether the world has something for Open-RMF: doors, lifts, or a robot that drives along its paths.
bool HasRmf(const WorldDescription& world);

// The fleet of a robot: the parameter "fleet" of a slotcar; else the tag "fleet:NAME" of the place where a building has
// it start; else the type of its model.
std::string FleetOf(const WorldDescription& world, RobotId robot);

// What follows `prefix` in the first tag of the place that begins with it; nothing without one.
std::optional<std::string> TagAfter(const NamedPlace& place, const std::string& prefix);

// The doors that take requests of their own: operated doors without those of lifts. By number.
std::vector<std::size_t> DoorsOf(const WorldDescription& world);

// The name of the level at a height.
std::string LevelAt(const WorldDescription& world, double z);

DoorMode ModeOf(const DoorState& door);
DoorStateMessage MakeDoorState(const Time& stamp, const std::string& name, const DoorState& door,
                               dds::WireArena& arena);

// The floor of a lift that is nearest to its cabin, by number.
std::size_t FloorOf(const LiftDescription& lift, const LiftState& state);
// The doors at that floor.
DoorMode DoorsAt(const LiftDescription& lift, const WorldState& state, std::size_t floor);
LiftStateMessage MakeLiftState(const Time& stamp, const WorldDescription& world, std::size_t lift,
                               const WorldState& state, LiftMode mode, const std::string& session,
                               dds::WireArena& arena);

// A place on a path of a robot.
struct RmfLocation {
  Time time = {};
  float x = 0.0F;  // m, W
  float y = 0.0F;
  float yaw = 0.0F;  // rad
  bool obeys_speed_limit = false;
  float speed_limit = 0.0F;  // m/s, on the way here
  std::string level;
  std::uint64_t index = 0;
};

// What Open-RMF knows of a robot.
enum class RobotMode : std::uint8_t {
  kIdle = 0,
  kCharging = 1,
  kMoving = 2,
  kPaused = 3,
  kWaiting = 4,
  kDocking = 7,
  kAdapterError = 8,
};
struct RmfRobot {
  std::string name;
  std::string model;
  std::string task;
  std::uint64_t seq = 0;  // of the message
  RobotMode mode = RobotMode::kIdle;
  std::uint64_t mode_request = 0;
  float battery = 100.0F;  // %
  RmfLocation location;
  std::vector<RmfLocation> path;  // that is left
};

RmfLocation FromMessage(const LocationMessage& message);
LocationMessage ToMessage(const RmfLocation& location, dds::WireArena& arena);

// `Message`: RobotStateMessage or LaterRobotStateMessage.
template <typename Message>
Message MakeRobotState(const RmfRobot& robot, dds::WireArena& arena) {
  Message message{};
  message.name = arena.Copy(robot.name);
  message.model = arena.Copy(robot.model);
  message.task_id = arena.Copy(robot.task);
  message.seq = robot.seq;
  message.mode.mode = static_cast<std::uint32_t>(robot.mode);
  message.mode.mode_request_id = robot.mode_request;
  if constexpr (requires { message.mode.performing_action; }) message.mode.performing_action = arena.Copy("");
  message.battery_percent = robot.battery;
  message.location = ToMessage(robot.location, arena);
  LocationMessage* location = arena.Fill(message.path, robot.path.size());
  for (const RmfLocation& each : robot.path) *location++ = ToMessage(each, arena);
  return message;
}

// `Message`: FleetStateMessage or LaterFleetStateMessage.
template <typename Message>
Message MakeFleetState(const std::string& fleet, const std::vector<const RmfRobot*>& robots, dds::WireArena& arena) {
  Message message{};
  message.name = arena.Copy(fleet);
  auto* state = arena.Fill(message.robots, robots.size());
  for (const RmfRobot* robot : robots) {
    *state = MakeRobotState<std::remove_reference_t<decltype(*state)>>(*robot, arena);
    ++state;
  }
  return message;
}

template <typename Message>
RmfRobot FromRobotState(const Message& message) {
  RmfRobot robot;
  robot.name = dds::Text(message.name);
  robot.model = dds::Text(message.model);
  robot.task = dds::Text(message.task_id);
  robot.seq = message.seq;
  robot.mode = static_cast<RobotMode>(message.mode.mode);
  robot.mode_request = message.mode.mode_request_id;
  robot.battery = message.battery_percent;
  robot.location = FromMessage(message.location);
  for (const LocationMessage& location : dds::Elements(message.path)) robot.path.push_back(FromMessage(location));
  return robot;
}

}  // namespace troupe::ros
