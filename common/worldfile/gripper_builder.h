// Describes the grippers of a world: finds the models and joints that their parts are. Private to this folder.
#pragma once

#include <string>
#include <vector>

#include "common/worldfile/build_context.h"
#include "common/worldfile/gripper_reader.h"
#include "common/worldfile/paddles.h"

namespace troupe {

// A `gripper` on a robot, while the world is being built.
struct GripperDraft {
  SourceLocation where;
  ModelId model;
  RobotId robot;
  GripperSettings settings;
  std::optional<OwnParts> own;
};

// Adds the descriptions of the grippers, once all models and joints are there.
class GripperBuilder {
 public:
  explicit GripperBuilder(BuildContext& context) : context_(context), world_(context.loaded.world) {}

  void Describe(const std::vector<GripperDraft>& drafts);

 private:
  void Describe(const GripperDraft& draft);
  ModelId FindModel(const GripperDraft& draft, const PartName& part, bool also_on_robot);
  JointId FindJoint(const GripperDraft& draft, const PartName& part, bool also_on_robot);
  ModelId FindPad(const GripperDraft& draft, const std::optional<PartName>& part, JointId finger);
  void CheckFingers(const GripperDraft& draft, const GripperDescription& gripper);
  // What both models are mounted on.
  ModelId Mount(ModelId left, ModelId right) const;
  std::vector<std::string> NamesBelow(const GripperDraft& draft) const;
  void Fail(const SourceLocation& where, const std::string& message) { context_.diagnostics.Fail(where, message); }

  BuildContext& context_;
  WorldDescription& world_;
};

}  // namespace troupe
