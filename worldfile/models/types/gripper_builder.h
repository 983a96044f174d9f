// Describes the grippers of a world: finds the models and joints of their parts. Private to this folder.
//
// Two kinds: Stage's gripper with two paddles and a lift, whose models and joints are made here, and a gripper whose
// fingers are actuators that the file has itself. Both end as one GripperDescription: two finger joints, their pads, an
// optional lift and two break beams between the open pads, so that the world service knows one kind only.
//
// Frame G is that of the mount, the nearest model that carries both fingers; beams are in G, m. Errors go to the
// diagnostics at the property that names the wrong part.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "worldfile/models/properties/model_shape.h"
#include "worldfile/models/properties/property_reader.h"

namespace troupe {

// Reads the properties of a `gripper`.

// A model of the gripper's tree that a property names.
struct PartName {
  std::string name;
  SourceLocation where;
};

// The two paddles and the lift of a gripper without named fingers.
struct PaddleSettings {
  Size size;                       // of one, m
  double travel = 0.0;             // m, of each, from open to touching the other
  double speed = 0.0;              // m/s
  bool closed = false;             // paddles, at load
  std::optional<Interval> height;  // m, the lift's range: their underside above the gripper; nothing: no lift
  double lift_speed = 0.0;         // m/s
  bool up = false;                 // lift, at load
};

struct GripperSettings {
  bool autosnatch = false;
  std::optional<PaddleSettings> paddles;  // nothing: its fingers are named
  std::optional<PartName> left_finger;
  std::optional<PartName> right_finger;
  std::optional<PartName> left_pad;
  std::optional<PartName> right_pad;
  std::optional<PartName> lift;
};

// `size` is the gripper's, m; `height` is its own above its robot's base, m.
GripperSettings ReadGripper(PropertyReader& reader, const Size& size, double height);

// The size of the part behind the paddles, m, and its pose in the gripper's frame M.
Size BackSize(const Size& size, const PaddleSettings& paddles);
Pose BackPose(const Pose& X_MD, const PaddleSettings& paddles);

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
