// Order: one demand for a tick beside motion: of a controller for the devices of its robot and for the doors and lifts
// of the building (Command::orders), and of a tool from outside (Input). The same value travels from the controller in
// the proposal to the step, which executes it.
//
// Orders are wishes: the step clamps, refuses or delays them by the state of the device. Lights, cameras and doors keep
// their last order, so that a controller need not repeat it. Orders of a kind are executed one after another, tools'
// orders before robots' (world-service/core/step.h); devices are named by index, not by name, because an order travels
// at every tick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <variant>

#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/pose.h"

namespace troupe {

// Switches a light of the robot. A light stays as it was switched last.
struct LightOrder {
  std::size_t light = 0;  // in RobotInfo::lights: among the robot's, in the order of models
  bool on = false;
  bool operator==(const LightOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"light", &LightOrder::light},
        Field{"on", &LightOrder::on},
    };
  }
};

// Turns a camera of the robot at once, away from its direction in the world file. It keeps its direction until it is
// turned again.
struct CameraOrder {
  std::size_t sensor = 0;  // in RobotInfo::sensors
  double pan = 0.0;        // rad, to the left
  double tilt = 0.0;  // rad, upwards; bounded so that its picture ends within 85 degrees above and below the horizontal
  bool operator==(const CameraOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"sensor", &CameraOrder::sensor},
        Field{"pan", &CameraOrder::pan},
        Field{"tilt", &CameraOrder::tilt},
    };
  }
};

// A request to the controls of a door. It stays valid until the next one of any robot or tool; of several robots in one
// tick the request that opens it farthest counts, and a robot's request replaces a tool's.
struct DoorOrder {
  std::size_t door = 0;  // in RobotInfo::doors and WorldDescription::doors
  double opening = 1.0;  // from 0, closed, to 1
  bool operator==(const DoorOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"door", &DoorOrder::door},
        Field{"opening", &DoorOrder::opening},
    };
  }
};

// A call of a lift. That of a robot begins a session: until the robot ends it, the calls of other robots do not count,
// and its own counts only while no other robot has one (Observation::lifts). That of a tool ends the session.
struct LiftOrder {
  std::size_t lift = 0;   // in RobotInfo::lifts and WorldDescription::lifts
  std::size_t floor = 0;  // in LiftInfo::floors
  bool ends = false;      // ends the session, without a call
  bool operator==(const LiftOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"lift", &LiftOrder::lift},
        Field{"floor", &LiftOrder::floor},
        Field{"ends", &LiftOrder::ends},
    };
  }
};

// Of a robot that takes part in the planned traffic of its lanes (TrafficRobot), in each tick in which it does.
// Vertices are counted through all graphs of the world.
struct TrafficOrder {
  std::uint32_t at = 0;                    // the vertex that it is at, of the graph that it drives on
  std::optional<std::uint32_t> goal = {};  // of the same graph; nothing: it makes room for others
  bool holds = false;                      // it stays where it is, for instance while it is loaded
  std::uint32_t finished = 0;              // moves since it takes part, modulo 2^32
  double driven = 0.0;                     // m, along the lane of its present move
  bool is_blocked = false;                 // a body that takes no part is in the way of its present move
  bool operator==(const TrafficOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"at", &TrafficOrder::at},
        Field{"goal", &TrafficOrder::goal},
        Field{"holds", &TrafficOrder::holds},
        Field{"finished", &TrafficOrder::finished},
        Field{"driven", &TrafficOrder::driven}.In("m"),
        Field{"blocked", &TrafficOrder::is_blocked},
    };
  }
};

// Of a robot that wants to charge (ChargingRobot), in each tick in which it does: the vertex that it wants for itself,
// counted through all graphs. It gets that unless another robot has it, or wants it with less energy.
struct ChargeOrder {
  std::optional<std::uint32_t> vertex = {};  // nothing: it waits, and keeps what it has
  bool at_charger = false;                   // the vertex is a charger, not a place where it waits for one
  bool operator==(const ChargeOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"vertex", &ChargeOrder::vertex},
        Field{"at_charger", &ChargeOrder::at_charger},
    };
  }
};

// Of a robot that brings goods (Job), in each tick in which it does.
struct JobOrder {
  bool is_free = false;   // it may get another job
  bool loads = false;     // it has the goods of its job from now on
  bool delivers = false;  // they are where they have to be
  bool operator==(const JobOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"free", &JobOrder::is_free},
        Field{"loads", &JobOrder::loads},
        Field{"delivers", &JobOrder::delivers},
    };
  }
};

// Takes an object onto the robot, or puts down one that it carries: by a hand-over, as a vehicle with a fork or rollers
// does at a station. It fails without an effect if the object is held, on another robot or farther than kLoadReach from
// the robot, or has no room where it is to be.
struct LoadOrder {
  ModelId object;     // the root of an object that is not mounted
  bool takes = true;  // onto the middle of the robot; else down, from the robot to:
  double x = 0.0;     // m, in W, of the origin of the object; its height is that on the robot, from which it falls
  double y = 0.0;
  bool operator==(const LoadOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"object", &LoadOrder::object},
        Field{"takes", &LoadOrder::takes},
        Field{"x", &LoadOrder::x}.In("m"),
        Field{"y", &LoadOrder::y}.In("m"),
    };
  }
};

inline constexpr double kLoadReach = 2.5;  // m, from the robot's origin

// Closes a lane for robots, limits their speed there, or lifts that (LaneRule), with all lanes on the same line. Of
// tools only.
struct LaneOrder {
  std::size_t lane = 0;      // counted through all graphs
  double speed_limit = 0.0;  // m/s; 0: closed; negative: as described
  bool operator==(const LaneOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"lane", &LaneOrder::lane},
        Field{"speed_limit", &LaneOrder::speed_limit}.In("m/s"),
    };
  }
};

// Switches a zone. Of tools only.
struct ZoneOrder {
  std::size_t zone = 0;  // in WorldDescription::zones
  bool on = false;
  bool operator==(const ZoneOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"zone", &ZoneOrder::zone},
        Field{"on", &ZoneOrder::on},
    };
  }
};

// Of a robot that stands on its way to a goal, in each tick in which it does (RobotWait).
struct WaitOrder {
  std::optional<ModelId> thing = {};       // for which it waits; nothing: it does not know
  std::optional<std::uint32_t> lane = {};  // on which it cannot go on, counted through all graphs
  bool operator==(const WaitOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"thing", &WaitOrder::thing},
        Field{"lane", &WaitOrder::lane},
    };
  }
};

// Sets the velocity of a robot at the end of the tick, from which its drive accelerates. Of tools only.
struct TwistOrder {
  Twist twist = {};  // in R, within the limits of the drive
  bool operator==(const TwistOrder&) const = default;
  static constexpr auto Fields() { return std::tuple{Field{"twist", &TwistOrder::twist}}; }
};

using Order = std::variant<LightOrder, CameraOrder, DoorOrder, LiftOrder, TwistOrder, TrafficOrder, ChargeOrder,
                           JobOrder, WaitOrder, LaneOrder, ZoneOrder, LoadOrder>;

// An order from outside of the simulation, for one tick.
struct Input {
  std::optional<RobotId> robot = {};  // whose device it concerns; nothing: a part of the building
  Order order = {};
  bool operator==(const Input&) const = default;
};

}  // namespace troupe
