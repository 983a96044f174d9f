// Proposal: an agent's request for its robot's next tick. The step decides how much of it is executed.
//
// One per robot and tick, a message of the agents to the world service. It is a wish: collisions, grippers, doors and
// energy decide in the step. It says velocities, not poses: a robot cannot jump, whatever its agent asks for. A
// proposal outside of the limits of the robot's devices is refused as a whole (device_limits.h, radio_limits.h).
#pragma once

#include <string>
#include <vector>

#include "troupe/fields.h"
#include "troupe/fleet_message.h"
#include "troupe/ids.h"
#include "troupe/order.h"
#include "troupe/pose.h"
#include "troupe/radio_message.h"

namespace troupe {

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
  std::vector<Order> orders = {};           // by kind (check_order.h); orders of a kind are executed one after another
  std::string say = {};                     // the text of an event, at most kMaxSaidBytes; empty: none
  std::vector<FleetMessage> fleet = {};     // to its fleet control, in order
  bool operator==(const Proposal&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"robot", &Proposal::robot},
        Field{"twist", &Proposal::twist},
        Field{"joint_velocities", &Proposal::joint_velocities},
        Field{"messages", &Proposal::messages},
        Field{"orders", &Proposal::orders},
        Field{"say", &Proposal::say},
        Field{"fleet", &Proposal::fleet},
    };
  }
};

}  // namespace troupe
