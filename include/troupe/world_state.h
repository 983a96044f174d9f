// WorldState: everything about a world that changes, at one tick. Copyable and hashable; a step, a replica and an agent
// that joins late need (description, state) and nothing else.
//
// Each type lists its fields (fields.h); docs/contributing.md has the places of a new one.
#pragma once

#include <vector>

#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/radio_message.h"
#include "troupe/world_description.h"

namespace troupe {

struct RobotState {
  Pose X_WR;             // of the robot's root model
  Twist twist;           // executed during the tick that ended here, in R; zero after a stall
  bool stalled = false;  // the last commanded motion was cut short by a contact
  bool operator==(const RobotState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &RobotState::X_WR},
        Field{"twist", &RobotState::twist},
        Field{"stalled", &RobotState::stalled},
    };
  }
};

struct JointState {
  double position = 0.0;  // m or rad
  double velocity = 0.0;  // m/s or rad/s, executed during the tick that ended here; zero after a contact
  bool blocked = false;   // the last commanded motion was cut short by a contact
  bool operator==(const JointState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"position", &JointState::position},
        Field{"velocity", &JointState::velocity},
        Field{"blocked", &JointState::blocked},
    };
  }
};

struct GripperState {
  std::optional<ModelId> left_contact = {};   // the model that stopped the left pad when it last closed
  std::optional<ModelId> right_contact = {};  // likewise
  // The object between the pads. The gripper holds it if the object's holder is this gripper; otherwise another
  // gripper holds it, and this one will when that one opens.
  std::optional<ObjectId> clamped = {};
  bool operator==(const GripperState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"left_contact", &GripperState::left_contact},
        Field{"right_contact", &GripperState::right_contact},
        Field{"clamped", &GripperState::clamped},
    };
  }
};

enum class ObjectMode : std::uint8_t {
  kPlaced = 0,   // at its place in the file, or released without gravity; it stays there, also in the air
  kResting = 1,  // on a support
  kFalling = 2,
  kHeld = 3,
  kMounted = 4,  // a leaf of a door or the cabin of a lift: it neither falls nor can be held
};
constexpr ObjectMode LastOf(ObjectMode) {
  return ObjectMode::kMounted;
}

struct ObjectState {
  Pose X_WO = {};  // of the object's root model
  ObjectMode mode = ObjectMode::kPlaced;
  double fall_speed = 0.0;               // m/s, downwards
  std::optional<GripperId> holder = {};  // in mode kHeld
  // In mode kResting: the model under the object's centre, with which it moves; nothing on the ground, or if the
  // centre is above no support.
  std::optional<ModelId> support = {};
  bool operator==(const ObjectState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &ObjectState::X_WO},
        Field{"mode", &ObjectState::mode},
        Field{"fall_speed", &ObjectState::fall_speed},
        Field{"holder", &ObjectState::holder},
        Field{"support", &ObjectState::support},
    };
  }
};

// A store of energy.
struct StoreState {
  double joules = 0.0;        // J; of an endless one as at load
  double charge_watts = 0.0;  // W that it has received during the tick that ended here, on average
  bool operator==(const StoreState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"joules", &StoreState::joules},
        Field{"charge_watts", &StoreState::charge_watts},
    };
  }
};

// The velocity of an inertial measurement unit, in W, during the tick before the last one: with the present one it
// gives the acceleration. An edit that changes the velocity of its robot sets it to the new one.
struct ImuState {
  double vx = 0.0;  // m/s
  double vy = 0.0;
  double vz = 0.0;
  bool operator==(const ImuState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"vx", &ImuState::vx},
        Field{"vy", &ImuState::vy},
        Field{"vz", &ImuState::vz},
    };
  }
};

// A light of a robot.
struct LightState {
  bool is_switched_on = true;
  bool operator==(const LightState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"switched_on", &LightState::is_switched_on},
    };
  }
};

// The direction of a camera, from that of the world file.
struct CameraState {
  double pan = 0.0;   // rad, to the left, in (-pi, pi]
  double tilt = 0.0;  // rad, upwards, within CameraParameters::TiltLimits
  bool operator==(const CameraState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pan", &CameraState::pan},
        Field{"tilt", &CameraState::tilt},
    };
  }
};

struct DoorState {
  double opening = 0.0;  // from 0, closed, to 1
  double target = 0.0;   // likewise, as it was requested last
  bool held = false;     // open for a robot within its reach or a person that asks, whatever the target
  bool blocked = false;  // the motion of the last tick was cut short by a body in its way
  bool operator==(const DoorState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"opening", &DoorState::opening},
        Field{"target", &DoorState::target},
        Field{"held", &DoorState::held},
        Field{"blocked", &DoorState::blocked},
    };
  }

  double commanded_opening() const { return held ? 1.0 : target; }  // the opening that it moves to
};

struct LiftState {
  double z = 0.0;                       // m, of the cabin's floor
  std::uint32_t floor = 0;              // that it moves to or stands at, in LiftDescription::floors
  std::optional<RobotId> session = {};  // the only robot whose orders count; nothing: any
  bool blocked = false;                 // the motion of the last tick was cut short by a body in its way
  bool operator==(const LiftState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"z", &LiftState::z},
        Field{"floor", &LiftState::floor},
        Field{"session", &LiftState::session},
        Field{"blocked", &LiftState::blocked},
    };
  }
};

// A person: its body, and where it is in its walks.
struct PersonState {
  Pose X_WP;        // of its root model
  double vx = 0.0;  // m/s, in W, during the tick that ended here
  double vy = 0.0;
  std::uint32_t goals = 0;    // its goal set
  std::uint32_t goal = 0;     // number of the point among those of the set
  std::uint32_t choices = 0;  // goals that it has chosen so far; 0: none yet
  std::uint32_t waits = 0;    // ticks until it leaves the goal that it has reached; 0: it walks
  std::uint32_t watched = 0;  // ticks for which it has watched robots, of a curious one
  std::uint32_t door = 0;     // the door that it asks for, by its number from 1 on; 0: none
  std::uint32_t lift = 0;     // that it goes to or rides, likewise
  std::uint32_t floor = 0;    // where it gets off, in LiftDescription::floors
  std::uint32_t called = 0;   // the tick (modulo 2^32) since which it calls that lift; 0: not yet
  std::uint32_t place = 0;    // where it stands in the cabin, or may get on to; from 1 on; 0: it waits
  // Ticks for which it has been getting on or off; while it waits, from its call to its last vain try to get on.
  std::uint32_t passing = 0;
  bool operator==(const PersonState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &PersonState::X_WP},   Field{"vx", &PersonState::vx},
        Field{"vy", &PersonState::vy},       Field{"goals", &PersonState::goals},
        Field{"goal", &PersonState::goal},   Field{"choices", &PersonState::choices},
        Field{"waits", &PersonState::waits}, Field{"watched", &PersonState::watched},
        Field{"door", &PersonState::door},   Field{"lift", &PersonState::lift},
        Field{"floor", &PersonState::floor}, Field{"called", &PersonState::called},
        Field{"place", &PersonState::place}, Field{"passing", &PersonState::passing},
    };
  }

  // It goes to no lift any more, or has left the one that it rode.
  void EndRide() { lift = floor = called = place = passing = 0; }
};

struct WorldState {
  Tick tick = 0;
  std::vector<RobotState> robots;         // by RobotId
  std::vector<JointState> joints;         // by JointId
  std::vector<GripperState> grippers;     // by GripperId
  std::vector<ObjectState> objects;       // by ObjectId
  std::vector<StoreState> stores = {};    // of FindStores
  std::vector<ImuState> imus = {};        // of FindImus
  std::vector<LightState> lights = {};    // of FindLights
  std::vector<CameraState> cameras = {};  // of FindCameras
  // On their way, or arriving at this tick; in the order of `sent`, then of robots, then of `number`.
  std::vector<RadioTransmission> transmissions = {};
  std::vector<DoorState> doors = {};     // of WorldDescription::doors
  std::vector<LiftState> lifts = {};     // of WorldDescription::lifts
  std::vector<PersonState> people = {};  // by PersonId
  bool operator==(const WorldState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"tick", &WorldState::tick},       Field{"robots", &WorldState::robots},
        Field{"joints", &WorldState::joints},   Field{"grippers", &WorldState::grippers},
        Field{"objects", &WorldState::objects}, Field{"stores", &WorldState::stores},
        Field{"imus", &WorldState::imus},       Field{"lights", &WorldState::lights},
        Field{"cameras", &WorldState::cameras}, Field{"transmissions", &WorldState::transmissions},
        Field{"doors", &WorldState::doors},     Field{"lifts", &WorldState::lifts},
        Field{"people", &WorldState::people},
    };
  }
};

// Calls visit(table) for each field that is a list of rows: Field<WorldState, std::vector<Row>>.
template <typename Visit>
constexpr void ForEachTable(Visit&& visit) {
  ForEachField<WorldState>([&]<typename Part>(const Field<WorldState, Part>& field) {
    if constexpr (requires { requires HasFields<typename Part::value_type>; }) visit(field);
  });
}

// The description's poses at tick 0. Every object is kPlaced: its support is not known here, so that a run begins with
// InitialState of world-service/core/step.h instead.
WorldState PlacedState(const WorldDescription& world);

// The bytes that a copy of the state needs in memory, about.
std::size_t MemoryOf(const WorldState& state);

}  // namespace troupe
