// Reads the properties of a `gripper`. Private to this folder.
#pragma once

#include <optional>
#include <string>

#include "common/worldfile/build_context.h"
#include "common/worldfile/shape_scaling.h"

namespace troupe {

// A model of the gripper's tree that a property names.
struct PartName {
  std::string name;
  SourceLocation where;
};

// Two paddles that the gripper has by itself, and what moves them.
struct PaddleSettings {
  Size size;                        // of one, m
  double travel = 0.0;              // m, of each, from open to touching the other
  double speed = 0.0;               // m/s
  bool closed = false;              // at load
  std::optional<Interval> height;   // m, of their underside above the gripper: its own lift's, if it has one
  double lift_speed = 0.0;          // m/s
  bool up = false;                  // at load
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

// `size` is the gripper's; `height` is where it is above its robot's base, m.
GripperSettings ReadGripper(PropertyReader& reader, const Size& size, double height);

// The size of the part behind the paddles, and its pose in the gripper, whose `origin` is given: the gripper's body.
Size BackSize(const Size& size, const PaddleSettings& paddles);
Pose BackOrigin(const Pose& origin, const PaddleSettings& paddles);

}  // namespace troupe
