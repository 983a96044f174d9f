// The paddles and the lift that a gripper has by itself. Private to this folder.
#pragma once

#include <optional>
#include <vector>

#include "common/worldfile/build_context.h"
#include "common/worldfile/gripper_reader.h"

namespace troupe {

struct OwnParts {
  std::vector<ModelId> models;
  JointId left;
  JointId right;
  std::optional<JointId> lift;
};

// Adds them to the world as models "lift", "left_paddle" and "right_paddle" of the gripper, which was added last.
// `origin` is the body's pose in the gripper. The paddles lie in front, along x, and close along y.
OwnParts AddPaddles(const PaddleSettings& settings, const Size& size, const Pose& origin, const SourceLocation& where,
                    ModelId gripper, RobotId robot, BuildContext& context);

// A model's name without that of its robot.
std::string NameOnRobot(const WorldDescription& world, RobotId robot, const std::string& name);

}  // namespace troupe
