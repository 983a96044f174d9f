// A command from outside of the simulation for one robot and tick.
#pragma once

#include "troupe/controller.h"

namespace troupe {

struct ExternalCommand {
  // Commands to grippers and joints are applied after the controller's. REQUIRES: they are valid for the robot.
  Command command = {};
  bool drives = false;  // the motion in `command` overrides the controller's
};

}  // namespace troupe
