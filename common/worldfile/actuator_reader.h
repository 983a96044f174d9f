// Reads what makes an `actuator` model a joint. Private to this folder.
#pragma once

#include "common/worldfile/build_context.h"

namespace troupe {

// The joint of an actuator in a robot's tree; robot, model and name are for the caller to fill in.
JointDescription ReadActuator(PropertyReader& reader);

// An actuator on no robot: checks its properties and warns that it does not move.
void ReadStandingActuator(PropertyReader& reader);

}  // namespace troupe
