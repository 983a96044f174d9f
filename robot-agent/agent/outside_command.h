// What comes from outside of a simulation for one robot and tick.
#pragma once

#include "robot-agent/controller/controller.h"

namespace troupe {

struct OutsideCommand {
  // Grippers and joints are told after the controller's command, and must be within what the robot can.
  Command command = {};
  bool drives = false;  // the motion in `command` goes before the controller's
};

}  // namespace troupe
