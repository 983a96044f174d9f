// Proposal: an agent's request for its robot's next tick. The step decides how much of it is executed.
#pragma once

#include <string>
#include <vector>

#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/radio_message.h"

namespace troupe {

// Switches a light of the robot on or off.
struct LightOrder {
  std::size_t light = 0;  // number among the robot's lights, in the order of models
  bool on = false;
  bool operator==(const LightOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"light", &LightOrder::light},
        Field{"on", &LightOrder::on},
    };
  }
};

// Turns a camera of the robot at once, as CameraState.
struct CameraOrder {
  std::size_t sensor = 0;  // of the robot
  double pan = 0.0;        // rad
  double tilt = 0.0;
  bool operator==(const CameraOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"sensor", &CameraOrder::sensor},
        Field{"pan", &CameraOrder::pan},
        Field{"tilt", &CameraOrder::tilt},
    };
  }
};

// Opens or closes a door. Of several orders for one door in a tick the one that opens it farthest counts.
struct DoorOrder {
  std::size_t door = 0;  // in WorldDescription::doors
  double target = 1.0;   // from 0, closed, to 1
  bool operator==(const DoorOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"door", &DoorOrder::door},
        Field{"target", &DoorOrder::target},
    };
  }
};

// Calls a lift to a floor, which begins a session of the robot, or ends the session.
struct LiftOrder {
  std::size_t lift = 0;  // in WorldDescription::lifts
  std::size_t floor = 0;
  bool ends = false;
  bool operator==(const LiftOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"lift", &LiftOrder::lift},
        Field{"floor", &LiftOrder::floor},
        Field{"ends", &LiftOrder::ends},
    };
  }
};

// Bytes of a text that a robot says in one tick.
inline constexpr std::size_t kMaxSaidBytes = 200;

struct Proposal {
  RobotId robot;
  Twist twist;  // in R, constant during the tick
  // The velocities of the robot's joints, in id order: m/s or rad/s, constant during the tick or until the joint's
  // limit. Empty: none moves. A finger that closes grips the object that both pads touch; a finger that opens releases
  // it.
  std::vector<double> joint_velocities = {};
  std::vector<RadioMessage> messages = {};  // within the limits of the radios (radio_limits.h)
  std::vector<LightOrder> lights = {};      // applied in order
  std::vector<CameraOrder> cameras = {};    // likewise
  std::string say = {};                     // an event for people, of at most kMaxSaidBytes; empty: none
  std::vector<DoorOrder> doors = {};
  std::vector<LiftOrder> lifts = {};
  bool operator==(const Proposal&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"robot", &Proposal::robot},
        Field{"twist", &Proposal::twist},
        Field{"joint_velocities", &Proposal::joint_velocities},
        Field{"messages", &Proposal::messages},
        Field{"lights", &Proposal::lights},
        Field{"cameras", &Proposal::cameras},
        Field{"say", &Proposal::say},
        Field{"doors", &Proposal::doors},
        Field{"lifts", &Proposal::lifts},
    };
  }
};

}  // namespace troupe
