// Motion of robots: the base along its twist, and each joint along its axis, together with what they carry.
#pragma once

#include <optional>
#include <span>

#include "common/spatial/sweep.h"
#include "world-service/core/step_workspace.h"

namespace troupe {

// Moves a robot's base as far as it gets; returns the contact that cut its motion short.
std::optional<Contact> MoveBase(StepWorkspace& workspace, RobotId robot, const Twist& twist);

// Moves one joint as far as it gets: to its limit, or to the contact that is returned. Objects that rest on a part that
// goes down follow it and do not stop it; what is held does.
std::optional<Contact> MoveJoint(StepWorkspace& workspace, JointId joint, double velocity);

}  // namespace troupe
