// From a RigidModel to a node of a world tree: a static model, a movable object, or a robot with its sensors.
//
// A model with `static` stands; one with a drive plugin, and every URDF, is a robot; others are objects, which may be
// gripped and fall. Its collisions are its body; without any, its visuals are, seen by sensors and hit by nothing, as
// in Gazebo. Joints are frozen at 0, but for prismatic ones of a robot, which become actuators, or the fingers of a
// gripper (gripper_guess.h). A robot stands on its lowest collision: its origin is on the floor below the origin of its
// root link.
#pragma once

#include <optional>

#include "worldfile/gazebo/rigid_model.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

enum class ModelUse : std::uint8_t { kAsWritten, kRobot };

// Nothing for a model without a body, such as a light. REQUIRES: T_PM of the model is in the frame of the node.
std::optional<WorldNode> ModelNode(const RigidModel& model, ModelUse use, Diagnostics& diagnostics);

}  // namespace troupe
