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

// Bytes of a text that a robot says in one tick.
inline constexpr std::size_t kMostSaidBytes = 200;

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
  std::string say = {};                     // an event for people, of at most kMostSaidBytes; empty: none
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
    };
  }
};

}  // namespace troupe
