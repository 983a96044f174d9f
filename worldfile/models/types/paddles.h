// The paddles and the lift that a gripper has by itself. Private to this folder.
#pragma once

#include <optional>
#include <vector>

#include "worldfile/models/properties/build_context.h"
#include "worldfile/models/types/gripper_settings.h"

namespace troupe {

struct OwnParts {
  std::vector<ModelId> models;
  JointId left;
  JointId right;
  std::optional<JointId> lift;
};

// Adds them to the world as models "lift", "left_paddle" and "right_paddle" of the gripper, which was added last.
// X_MD: the body in the gripper. The paddles lie in front, along x, and close along y.
OwnParts AddPaddles(const PaddleSettings& settings, const Size& size, const Pose& X_MD, const SourceLocation& where,
                    ModelId gripper, RobotId robot, BuildContext& context);

}  // namespace troupe
