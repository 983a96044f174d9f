// Reads the properties of a `gripper`. Private to this folder.
#pragma once

#include <optional>
#include <string>

#include "worldfile/models/properties/build_context.h"
#include "worldfile/models/properties/shape_scaling.h"

namespace troupe {

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

}  // namespace troupe
