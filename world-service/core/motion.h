// Motion of robots: the base along its twist, and each joint along its axis, with their payloads.
#pragma once

#include <optional>
#include <span>

#include "common/spatial/sweep.h"
#include "world-service/core/step_workspace.h"

namespace troupe {

// Moves a robot's base until its first contact, which is returned.
std::optional<Contact> MoveBase(StepWorkspace& workspace, RobotId robot, const Twist& twist);

// Moves one joint to its limit, or to the first contact, which is returned. Objects that rest on a part that moves down
// follow it and do not stop it; a held object does.
std::optional<Contact> MoveJoint(StepWorkspace& workspace, JointId joint, double velocity);

}  // namespace troupe
