// WorldState: everything about a world that changes, at one tick. Copyable and hashable; a step, a replica and an agent
// that joins late need (description, state) and nothing else.
//
// Each type lists its fields (fields.h); docs/contributing.md has the places of a new one.
#pragma once

#include <vector>

#include "troupe/enum_names.h"
#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/radio_message.h"
#include "troupe/site_state.h"
#include "troupe/traffic_state.h"
#include "troupe/world_description.h"

namespace troupe {

struct RobotState {
  Pose X_WR;
  Twist twist;
  bool stalled = false;
  bool operator==(const RobotState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &RobotState::X_WR, "of the root model, in W"},
        Field{"twist", &RobotState::twist, "executed during the tick that ended here, in R; zero after a stall"},
        Field{"stalled", &RobotState::stalled, "the last commanded motion was cut short by a contact"},
    };
  }
};

struct JointState {
  double position = 0.0;
  double velocity = 0.0;
  bool blocked = false;
  bool operator==(const JointState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"position", &JointState::position}.In("m or rad"),
        Field{"velocity", &JointState::velocity, "executed during the tick that ended here; zero after a contact"}.In(
            "m/s or rad/s"),
        Field{"blocked", &JointState::blocked, "the last commanded motion was cut short by a contact"},
    };
  }
};

struct GripperState {
  std::optional<ModelId> left_contact = {};
  std::optional<ModelId> right_contact = {};
  // The gripper holds this object if the object's holder is this gripper; otherwise another gripper holds it, and this
  // gripper will hold it once the other opens.
  std::optional<ObjectId> clamped = {};
  bool operator==(const GripperState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"left_contact", &GripperState::left_contact, "the model that stopped the left pad when it last closed"},
        Field{"right_contact", &GripperState::right_contact,
              "the model that stopped the right pad when it last closed"},
        Field{"clamped", &GripperState::clamped, "the object between the pads"},
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
constexpr auto NamesOf(ObjectMode) {
  return std::array{"placed", "resting", "falling", "held", "mounted"};
}

struct ObjectState {
  Pose X_WO = {};
  ObjectMode mode = ObjectMode::kPlaced;
  double fall_speed = 0.0;
  std::optional<GripperId> holder = {};  // in mode kHeld and only then
  std::optional<ModelId> support = {};  // in mode kResting; nothing on the ground, or if the centre is above no support
  bool operator==(const ObjectState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &ObjectState::X_WO, "of the root model, in W"},
        Field{"mode", &ObjectState::mode, "0 placed, 1 resting, 2 falling, 3 held, 4 mounted"},
        Field{"fall_speed", &ObjectState::fall_speed, "downwards"}.In("m/s"),
        Field{"holder", &ObjectState::holder, "the gripper that holds it"},
        Field{"support", &ObjectState::support, "the model under its centre, with which it moves"},
    };
  }
};

// A store of energy.
struct StoreState {
  double joules = 0.0;
  double charge_watts = 0.0;
  bool operator==(const StoreState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"joules", &StoreState::joules, "content; of an endless store as at load"}.In("J"),
        Field{"charge_watts", &StoreState::charge_watts, "received during the tick that ended here, on average"}.In(
            "W"),
    };
  }
};

// The velocity of an inertial measurement unit, in W, during the tick before the last one: with the present one it
// gives the acceleration. An edit that changes the velocity of its robot sets it to the new one.
struct ImuState {
  double vx = 0.0;
  double vy = 0.0;
  double vz = 0.0;
  bool operator==(const ImuState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"vx", &ImuState::vx}.In("m/s"),
        Field{"vy", &ImuState::vy}.In("m/s"),
        Field{"vz", &ImuState::vz}.In("m/s"),
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
  double pan = 0.0;
  double tilt = 0.0;
  bool operator==(const CameraState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pan", &CameraState::pan, "to the left, in (-pi, pi]"}.In("rad"),
        Field{"tilt", &CameraState::tilt, "upwards, within CameraParameters::TiltLimits"}.In("rad"),
    };
  }
};

struct DoorState {
  double opening = 0.0;
  double target = 0.0;
  bool held = false;
  bool blocked = false;
  std::uint32_t hold_ticks = 0;
  bool operator==(const DoorState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"opening", &DoorState::opening, "from 0, closed, to 1"}.Within(0, 1),
        Field{"target", &DoorState::target, "the opening that was requested last"}.Within(0, 1),
        Field{"held", &DoorState::held,
              "open for a body at its sensor, a person, or a body that stopped it, whatever the target"},
        Field{"blocked", &DoorState::blocked, "the motion of the last tick was cut short by a body"},
        Field{"hold_ticks", &DoorState::hold_ticks, "for which it stays open after it has opened"}.In("tick"),
    };
  }

  double commanded_opening() const { return held ? 1.0 : target; }  // the opening that it moves to
};

struct LiftState {
  double z = 0.0;
  std::uint32_t floor = 0;
  std::optional<RobotId> session = {};
  bool blocked = false;
  bool overloaded = false;
  bool operator==(const LiftState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"z", &LiftState::z, "of the cabin's floor"}.In("m"),
        Field{"floor", &LiftState::floor, "destination or present stop, in LiftDescription::floors"},
        Field{"session", &LiftState::session, "the only robot whose orders count; none: any"},
        Field{"blocked", &LiftState::blocked, "the motion of the last tick was cut short by a body"},
        Field{"overloaded", &LiftState::overloaded, "more is in the cabin than it carries: its doors stay open"},
    };
  }
};

// A person: its body, and its progress through its goals, and through doors and lifts on the way.
struct PersonState {
  Pose X_WP;
  double vx = 0.0;
  double vy = 0.0;
  std::uint32_t goals = 0;
  std::uint32_t goal = 0;
  std::uint32_t goals_chosen = 0;
  std::uint32_t dwell_ticks = 0;
  std::uint32_t watch_ticks = 0;
  std::uint32_t door = 0;
  std::uint32_t lift = 0;
  std::uint32_t floor = 0;
  std::uint32_t call_tick = 0;
  std::uint32_t place = 0;
  // In the doorway of the cabin: the duration of getting on or off so far. Outside, with place 0: the time from the
  // call to the last failed attempt to get on, which puts the person behind all later calls.
  std::uint32_t boarding_ticks = 0;
  bool operator==(const PersonState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &PersonState::X_WP, "of the root model, in W"},
        Field{"vx", &PersonState::vx, "in W, during the tick that ended here"}.In("m/s"),
        Field{"vy", &PersonState::vy, "in W, during the tick that ended here"}.In("m/s"),
        Field{"goals", &PersonState::goals, "the goal set, in WorldDescription::goal_sets"},
        Field{"goal", &PersonState::goal, "the point, among the points of the set"},
        Field{"goals_chosen", &PersonState::goals_chosen, "so far; 0: none yet"},
        Field{"dwell_ticks", &PersonState::dwell_ticks, "left at the goal; 0: it walks"}.In("tick"),
        Field{"watch_ticks", &PersonState::watch_ticks, "spent on watching robots, of a curious person"}.In("tick"),
        Field{"door", &PersonState::door, "requested by the person, by its number from 1 on; 0: none"},
        Field{"lift", &PersonState::lift, "called or ridden, by its number from 1 on; 0: none"},
        Field{"floor", &PersonState::floor, "destination, in LiftDescription::floors"},
        Field{"call_tick", &PersonState::call_tick, "of the call of the lift, modulo 2^32; 0: not yet"}.In("tick"),
        Field{"place", &PersonState::place, "in the cabin, assigned or taken, from 1 on; 0: it waits outside"},
        Field{"boarding_ticks", &PersonState::boarding_ticks,
              "of getting on or off; outside, from the call to the last failed attempt"}
            .In("tick"),
    };
  }

  // Clears the lift trip.
  void EndRide() { lift = floor = call_tick = place = boarding_ticks = 0; }
};

// People that are away are this far below the world: no level, sensor or body is there.
inline constexpr double kAwayZ = -500'000.0;  // m

// The person is not in the world: it has not come yet, or has left (VisitorDescription).
constexpr bool IsAway(const Pose& X_WP) {
  return X_WP.z < 0.5 * kAwayZ;
}
constexpr bool IsAway(const PersonState& person) {
  return IsAway(person.X_WP);
}

// A person that is not in the world all the time.
struct VisitorState {
  bool is_due = false;
  std::uint32_t visits = 0;
  bool operator==(const VisitorState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"due", &VisitorState::is_due, "it enters as soon as there is room"},
        Field{"visits", &VisitorState::visits, "so far, the present one included"},
    };
  }
};

// The people of a VisitorFlow so far.
struct VisitorFlowState {
  std::uint32_t came = 0;
  std::uint32_t refused = 0;
  bool operator==(const VisitorFlowState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"came", &VisitorFlowState::came, "people so far, those that wait for room to enter included"},
        Field{"refused", &VisitorFlowState::refused, "people for which all bodies of the flow were in use"},
    };
  }
};

struct WorldState {
  Tick tick = 0;
  std::vector<RobotState> robots;
  std::vector<JointState> joints;
  std::vector<GripperState> grippers;
  std::vector<ObjectState> objects;
  std::vector<StoreState> stores = {};
  std::vector<ImuState> imus = {};
  std::vector<LightState> lights = {};
  std::vector<CameraState> cameras = {};
  std::vector<RadioTransmission> transmissions = {};  // in the order of `sent`, then of robots, then of `number`
  std::vector<DoorState> doors = {};
  std::vector<LiftState> lifts = {};
  std::vector<PersonState> people = {};
  std::vector<TrafficRobot> traffic_robots = {};  // ascending
  std::vector<TrafficMove> traffic_moves = {};    // in the order of the plan
  std::vector<LaneClosure> lane_closures = {};    // ascending
  std::vector<LaneRule> lane_rules = {};          // ascending
  std::vector<ZoneState> zones = {};
  std::vector<CoverageState> coverage = {};
  std::vector<ChargingRobot> charging_robots = {};  // ascending
  std::vector<FlowState> flows = {};
  std::vector<Job> jobs = {};         // in the order of their times, then of flows
  std::vector<RobotWait> waits = {};  // ascending
  std::vector<VisitorState> visitors = {};
  std::vector<VisitorFlowState> visitor_flows = {};
  bool operator==(const WorldState&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"tick", &WorldState::tick}.In("tick"),
        Field{"robots", &WorldState::robots, "by RobotId"},
        Field{"joints", &WorldState::joints, "by JointId"},
        Field{"grippers", &WorldState::grippers, "by GripperId"},
        Field{"objects", &WorldState::objects, "by ObjectId"},
        Field{"stores", &WorldState::stores, "in the order of FindStores"},
        Field{"imus", &WorldState::imus, "in the order of FindImus"},
        Field{"lights", &WorldState::lights, "in the order of FindLights"},
        Field{"cameras", &WorldState::cameras, "in the order of FindCameras"},
        Field{"transmissions", &WorldState::transmissions, "radio messages on their way, or arriving at this tick"},
        Field{"doors", &WorldState::doors, "in the order of WorldDescription::doors"},
        Field{"lifts", &WorldState::lifts, "in the order of WorldDescription::lifts"},
        Field{"people", &WorldState::people, "by PersonId"},
        Field{"traffic_robots", &WorldState::traffic_robots, "robots that take part in the planned traffic of lanes"},
        Field{"traffic_moves", &WorldState::traffic_moves, "of these robots, in the order of the plan"},
        Field{"lane_closures", &WorldState::lane_closures, "lanes that the plan does not use"},
        Field{"lane_rules", &WorldState::lane_rules, "lanes that an operator has closed or slowed down"},
        Field{"zones", &WorldState::zones, "in the order of WorldDescription::zones"},
        Field{"coverage", &WorldState::coverage, "of cleaning zones, 32 cells a row (common/model/zones.h)"},
        Field{"charging_robots", &WorldState::charging_robots, "robots that want to charge"},
        Field{"flows", &WorldState::flows, "in the order of WorldDescription::flows"},
        Field{"jobs", &WorldState::jobs, "goods that wait to be brought somewhere, or are on their way"},
        Field{"waits", &WorldState::waits, "robots that wait on their ways to goals"},
        Field{"visitors", &WorldState::visitors, "in the order of WorldDescription::visitors"},
        Field{"visitor_flows", &WorldState::visitor_flows, "in the order of WorldDescription::visitor_flows"},
    };
  }
};

// The tables with another number of rows in each tick.
template <typename Row>
inline constexpr bool kIsVaryingTable =
    std::is_same_v<Row, RadioTransmission> || std::is_same_v<Row, TrafficRobot> || std::is_same_v<Row, TrafficMove> ||
    std::is_same_v<Row, LaneClosure> || std::is_same_v<Row, LaneRule> || std::is_same_v<Row, ChargingRobot> ||
    std::is_same_v<Row, Job> || std::is_same_v<Row, RobotWait>;

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
