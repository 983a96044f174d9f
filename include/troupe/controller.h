// Controller: decides the motion of a robot. Write one, build it as a shared library, and name it in a scenario; see
// docs/controllers.md and examples/own_controller. A controller needs no header but this one.
//
// A controller runs in its robot's agent process. In each tick it receives an Observation of the world at tick n and
// returns the Command for tick n + 1. To keep runs repeatable it must depend on its observations and parameters alone:
// no clock, no random seed of its own (Observation::Random gives repeatable draws), and SinCos, Atan2, Log and
// WrapAngle in place of the functions of <cmath>, whose last bits differ between processors.
//
// Sensors, joints and grippers have their indices in RobotInfo::sensors, joints and grippers; the lists of an
// Observation are as long and in the same order. Frames: W world, R robot. Units: m, rad, s and their quotients.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/deterministic_math.h"
#include "troupe/enum_names.h"
#include "troupe/fleet_message.h"
#include "troupe/ids.h"
#include "troupe/order.h"
#include "troupe/parameters.h"
#include "troupe/pose.h"
#include "troupe/radio_limits.h"
#include "troupe/random.h"
#include "troupe/robot_command.h"
#include "troupe/sensor.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

// A model of the world that a sensor or gripper recognizes. The name lives as long as the controller.
struct SeenModel {
  ModelId id;
  std::string_view name = {};
  bool operator==(const SeenModel&) const = default;
};

struct JointReading {
  double position = 0.0;  // m or rad
  double velocity = 0.0;  // m/s or rad/s, executed during the last tick
  bool blocked = false;   // a contact ended the last tick's motion
  bool moving = false;    // on its way to its target; false at the target, or blocked
};

enum class FingerState : std::uint8_t {
  kOpen,  // all the way
  kClosing,
  kClosed,  // they cannot close further: on an object, on another contact, or on each other; or they stay half open
  kOpening,
};
constexpr auto NamesOf(FingerState) {
  return std::array{"open", "closing", "closed", "opening"};
}

enum class FingerCommand : std::uint8_t {
  kOpen,
  kClose,
  kStay,  // at their positions, with the object that they hold
};
constexpr auto NamesOf(FingerCommand) {
  return std::array{"open", "close", "stay"};
}

struct GripperReading {
  FingerState fingers = FingerState::kOpen;
  bool lift_moving = false;                    // on its way to its target height; false at the target, or blocked
  double lift_position = 0.0;                  // m
  double lift_percent = 0.0;                   // of the way from its minimum to its maximum
  std::optional<SeenModel> left_contact = {};  // the model that stopped the pad when it last closed
  std::optional<SeenModel> right_contact = {};
  std::optional<SeenModel> held = {};     // the object that it holds
  std::optional<SeenModel> clamped = {};  // the object between its pads, also while another gripper still holds it
  // The object that breaks each beam. Only where the controller subscribes to GripperInfo::beams, or with autosnatch.
  std::vector<std::optional<SeenModel>> beams = {};
};

// A part without a value keeps its last command.
struct GripperCommand {
  std::size_t gripper = 0;
  std::optional<FingerCommand> fingers = {};
  std::optional<double> lift = {};  // percent, 0 to 100
  // In place of `fingers`: the opening, percent, 0 (kClose) to 100 (kOpen). Fingers that touch an object on the way
  // hold it.
  std::optional<double> opening = {};
};

// One of the two; valid until the next command to the same joint. Only a GripperCommand moves fingers; for a lift the
// last command of either kind is valid.
struct JointCommand {
  std::size_t joint = 0;
  std::optional<double> position = {};  // m or rad, within the joint's limits: moves there and stays
  std::optional<double> velocity = {};  // m/s or rad/s, up to the joint's limit. Bounded by the joint's speed.
};

// A gripper of the robot. The description lives as long as the controller; its ids are of the world.
struct GripperInfo {
  const GripperDescription* description = nullptr;  // never null
  std::size_t left = 0;                             // in RobotInfo::joints
  std::size_t right = 0;
  std::optional<std::size_t> lift = {};
  std::optional<std::size_t> beams = {};  // its break beams, in RobotInfo::sensors
};

// The store of energy that feeds the robot's drive.
struct EnergyReading {
  double joules = 0.0;
  double capacity = 0.0;      // J; 0: the store is endless
  double charge_watts = 0.0;  // W that it received during the last tick, on average
};

// A light of the robot. The name lives as long as the controller.
struct LightInfo {
  ModelId model;
  std::string_view name = {};  // without the robot's: "beacon"
  bool operator==(const LightInfo&) const = default;
};

// The disc around its hinge that a turning leaf of a door stays in.
struct LeafSweep {
  Vec2 hinge{0.0, 0.0};  // m, in W
  double radius = 0.0;   // m
  bool operator==(const LeafSweep&) const = default;
};

// A door of the world, which its controls tell every robot about.
struct DoorInfo {
  std::string name;
  Vec2 middle{0.0, 0.0};               // m, of the doorway, in W
  double z = 0.0;                      // m, of its floor
  std::vector<LeafSweep> sweeps = {};  // of the leaves that turn
  bool operator==(const DoorInfo&) const = default;
};

// A lift of the world.
struct LiftInfo {
  std::string name;
  Vec2 middle{0.0, 0.0};  // m, of the cabin, in W
  std::vector<std::string> floors;
  std::vector<std::vector<std::size_t>> doors = {};  // by floor: the doors that open there, in RobotInfo::doors
  bool operator==(const LiftInfo&) const = default;
};

struct Observation {
  Tick tick = 0;
  double time = 0.0;      // s, simulated
  double interval = 0.0;  // s, length of a tick
  Pose pose_estimate;     // of R, by the robot's localization: in frame world (gps) or odom (odometry)
  Twist twist;            // executed during the last tick, in R
  bool stalled = false;
  std::span<const SensorReading> sensors;  // by sensor, as in RobotInfo; empty where not subscribed
  std::span<const JointReading> joints;
  std::span<const GripperReading> grippers;
  std::vector<bool> lights = {};             // switched on, by light
  std::span<const DoorState> doors = {};     // by door
  std::span<const LiftState> lifts = {};     // by lift
  std::optional<EnergyReading> energy = {};  // nothing: the robot needs none
  std::uint64_t random_key = 0;              // of this robot and tick
  // That a user has sent the robot to, in the frame of `pose_estimate`; null: none, or it was cancelled or has expired.
  // Another number is another goal. Only for a controller that accepts goals.
  const Goal* goal = nullptr;
  std::span<const FleetMessage> fleet = {};  // that have arrived for this robot from its fleet control
  bool is_overridden = false;                // a user drives the robot in this tick, in place of the command

  // The i-th of this tick's uniform random numbers in [0, 1), the same in every run with the same seed.
  double Random(std::uint64_t i) const { return RandomUniform({random_key, i}); }
};

// The command for one tick. The drive bounds the motion (common/model/device_limits.h), which ends with the tick; a
// command to a gripper or joint is valid until the next one to it.
struct Command {
  Twist twist = {};       // differential and omni drives, in R
  double speed = 0.0;     // m/s, car drive: speed of the steered wheel
  double steering = 0.0;  // rad, car drive
  // Applied in order, grippers first. A number that is not finite, a percentage or position out of range, or an unknown
  // gripper or joint is a failure of the controller.
  std::vector<GripperCommand> grippers = {};
  std::vector<JointCommand> joints = {};
  // A line for the log of the run. Only the start of a long text is printed, and only some of many lines.
  std::string report = {};
  // The messages to send in this tick, in order, by the robot's radios; without a delay they arrive in the observations
  // of the next tick. Messages beyond the radio's bytes of a tick (BytesPerTick) are not sent. A sensor that
  // is no radio is a failure of the controller.
  std::vector<RadioMessage> messages = {};
  // To lights, cameras, doors and lifts; executed in order. One for a device that the robot or the world does not have,
  // or with a value out of its range, is a failure of the controller.
  std::vector<Order> orders = {};
  // The text of an event of the run (EventType::kSaid); beyond 200 bytes it is cut off.
  std::string say = {};
  // To the fleet control of the robot; those beyond the limits of FleetMessage are a failure of the controller.
  std::vector<FleetMessage> fleet = {};
};

// A sensor of the robot. The description lives as long as the controller.
struct SensorInfo {
  const SensorDescription* description = nullptr;  // never null
  Pose X_RM = {};  // of the sensor's model on the robot, with all joints at their starts
};

// The knowledge of a controller about its robot before the first tick.
struct RobotInfo {
  RobotId id = {};                                   // as other robots see it, for instance in RadioReception::from
  const RobotDescription* robot = nullptr;           // never null; lives as long as the controller
  std::string parameters = "{}";                     // a JSON object
  std::vector<SensorInfo> sensors = {};              // RobotDescription::sensors, then the break beams of grippers
  std::vector<const JointDescription*> joints = {};  // in id order; never null, live as long as the controller
  std::vector<GripperInfo> grippers = {};            // in id order
  std::vector<LightInfo> lights = {};                // in id order
  std::vector<DoorInfo> doors = {};                  // of the world, in the order of its models
  std::vector<LiftInfo> lifts = {};                  // of the world, in the order of its models
  Pose start = {};                                   // of R in W, when the world was loaded or the robot spawned
  // Of the world, ascending by their numbers; their doors and lifts are indices into `doors` and `lifts`. They live as
  // long as the controller.
  std::span<const LaneGraph> lane_graphs = {};
};

class Controller {
 public:
  virtual ~Controller() = default;

  // Indices, in RobotInfo::sensors, of the sensors that Update reads. The others are not measured.
  virtual std::vector<std::size_t> Subscriptions() const { return {}; }

  // Returns the command for the next tick. Called once each tick, in order; ticks may be missing after an absence of
  // the agent. An exception stops the robot and is reported; the run continues.
  virtual Command Update(const Observation& observation) = 0;

  // True if Update reads the goal of its observation. A goal for a robot whose controller accepts none is refused.
  virtual bool AcceptsGoals() const { return false; }

  // A controller that continues as this one would, for a snapshot of a simulation: one that decides by its
  // observations and members returns std::make_unique<Type>(*this). Null: this controller cannot be copied, and a
  // simulation with it has no snapshots.
  virtual std::unique_ptr<Controller> Clone() const { return nullptr; }
};

}  // namespace troupe

// A shared library defines these two (TROUPE_CONTROLLER does it):
//   extern "C" int troupe_controller_abi();
//   extern "C" troupe::Controller* troupe_create_controller(const troupe::RobotInfo& info);   // throws std::exception
#define TROUPE_CONTROLLER_ABI 13
#define TROUPE_CONTROLLER(Type)                                                                   \
  extern "C" __attribute__((visibility("default"))) int troupe_controller_abi() {                 \
    return TROUPE_CONTROLLER_ABI;                                                                 \
  }                                                                                               \
  extern "C" __attribute__((visibility("default"))) troupe::Controller* troupe_create_controller( \
      const troupe::RobotInfo& info) {                                                            \
    return new Type(info);                                                                        \
  }
