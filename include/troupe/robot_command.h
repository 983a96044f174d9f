// RobotCommand: a command from outside of the simulation to one robot, for one tick. The world service receives it from
// a tool or a viewer and sends it with the frame, so that it is an input of the tick like any other: the same commands
// at the same ticks give the same run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "troupe/fields.h"
#include "troupe/fleet_message.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "troupe/vec2.h"

namespace troupe {

struct WorldDescription;

// A part without a value keeps its last command.
//
// No Order (troupe/order.h), because the step never executes it: the agent's gripper turns its percentages, which stay
// in force for the ticks of the command, into motions of joints, and only these are in the proposal. As an Order it
// would need columns in proposals and inputs that nothing fills, and a number of ticks that no other order has.
struct GripperOrder {
  std::size_t gripper = 0;             // among the robot's grippers, in id order
  std::optional<double> opening = {};  // percent, 0 (closed) to 100 (open)
  std::optional<double> lift = {};     // percent of the way from its minimum to its maximum
  bool operator==(const GripperOrder&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"gripper", &GripperOrder::gripper},
        Field{"opening", &GripperOrder::opening},
        Field{"lift", &GripperOrder::lift},
    };
  }
};

// Points for a controller that accepts goals (troupe/controller.h).
struct Goal {
  std::uint32_t number = 0;            // another number is another goal
  std::vector<Vec2> waypoints;         // in W, to be reached one after another; not empty
  std::optional<double> heading = {};  // at the last one, rad
  std::vector<double> heights = {};    // of the floors at the points, m in W; none: on the level of the robot
  bool operator==(const Goal&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"number", &Goal::number},
        Field{"waypoints", &Goal::waypoints},
        Field{"heading", &Goal::heading},
        Field{"heights", &Goal::heights},
    };
  }
};

inline constexpr std::size_t kMaxWaypoints = 1000;

struct RobotCommand {
  RobotId robot;
  std::optional<Twist> twist = {};  // in R, in place of the controller's motion; the drive bounds it
  std::vector<GripperOrder> grippers = {};
  std::optional<Goal> goal = {};
  std::vector<FleetMessage> messages = {};  // to its controller, in one tick
  bool operator==(const RobotCommand&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"robot", &RobotCommand::robot},       Field{"twist", &RobotCommand::twist},
        Field{"grippers", &RobotCommand::grippers}, Field{"goal", &RobotCommand::goal},
        Field{"messages", &RobotCommand::messages},
    };
  }
};

// Success if the robot is in the world and can execute the command. The error names the robot.
Status CheckRobotCommand(const WorldDescription& world, const RobotCommand& command);

}  // namespace troupe
