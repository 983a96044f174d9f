// Describes the grippers of a world: finds the models and joints of their parts. Private to this folder.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "worldfile/models/properties/build_context.h"
#include "worldfile/models/types/gripper_settings.h"

namespace troupe {

// The paddles and the lift that a gripper has by itself.
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

// A `gripper` on a robot, while the world is being built.
struct GripperDraft {
  SourceLocation where;
  ModelId model;
  RobotId robot;
  GripperSettings settings;
  std::optional<OwnParts> own;
};

// Adds the descriptions of grippers. REQUIRES: all models and joints are in the world.
class GripperBuilder {
 public:
  explicit GripperBuilder(BuildContext& context) : context_(context), world_(context.world) {}

  void Describe(const GripperDraft& draft);

 private:
  ModelId FindModel(const GripperDraft& draft, const PartName& part, bool also_on_robot);
  JointId FindJoint(const GripperDraft& draft, const PartName& part, bool also_on_robot);
  ModelId FindPad(const GripperDraft& draft, const std::optional<PartName>& part, JointId finger);
  void CheckFingers(const GripperDraft& draft, const GripperDescription& gripper);
  // The nearest model that carries both.
  ModelId Mount(ModelId left, ModelId right) const;
  std::vector<std::string> NamesBelow(const GripperDraft& draft) const;
  void Fail(const SourceLocation& where, const std::string& message) { context_.diagnostics.Fail(where, message); }

  BuildContext& context_;
  WorldDescription& world_;
};

}  // namespace troupe
