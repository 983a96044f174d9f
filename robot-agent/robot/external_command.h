// A command from outside of the simulation for one robot and tick.
#pragma once

#include <optional>

#include "troupe/controller.h"
#include "troupe/robot_command.h"

namespace troupe {

struct ExternalCommand {
  // Commands to grippers, joints and radios are applied after the controller's. REQUIRES: they are valid for the robot.
  Command command = {};
  bool drives = false;            // the motion in `command` overrides the controller's
  std::optional<Goal> goal = {};  // for a controller that accepts goals
};

// Adds a command of a frame, whose motion overrides one that is there. REQUIRES: CheckRobotCommand succeeded.
void AddCommand(const RobotCommand& added, const DriveDescription& drive, ExternalCommand& external);

}  // namespace troupe
