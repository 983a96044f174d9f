// Solids: the world at one tick as prisms to be drawn.
//
// A picture needs outlines and heights, not collisions: bitmaps become outlines (rectangle_outline.h), except for dense
// areas, which are drawn as masks. Built for each picture; pointers refer to the world.
#pragma once

#include <optional>
#include <vector>

#include "troupe/polygon.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"
#include "troupe/z_range.h"

namespace troupe {

enum class SolidKind : std::uint8_t {
  kMap,     // a static bitmap
  kObject,  // any other model without a drive
  kRobot,   // part of a robot
};

struct Solid {
  SolidKind kind = SolidKind::kObject;
  ModelId model;
  std::optional<RobotId> robot;
  std::vector<Polygon> loops;  // m, frame W; the area inside an odd number of them
  Rectangle box;               // m, frame W, around the loops or the area
  // The area of a dense bitmap instead of loops, and the pose of its model. Part of the world that is drawn.
  const PixelArea* area = nullptr;
  Pose X_WM;
  std::vector<Rectangle> cover;  // m, frame W: boxes that cover a map's area (roughly, where it is turned)
  ZRange z;                      // m, frame W
  double height = 0.0;  // 0..1: where its top lies between the lowest and the highest of its kind or robot; 1: floors
};

// All blocks and bitmaps, in the order of models and blocks.
std::vector<Solid> CollectSolids(const WorldDescription& world, const WorldState& state);

// Around all solids of each robot, m, frame W; a robot without a body is a point, a removed one is not shown.
struct RobotExtent {
  Rectangle box;
  ZRange z;
  bool shown = true;
};
std::vector<RobotExtent> RobotExtents(const std::vector<Solid>& solids, const WorldDescription& world,
                                      const WorldState& state);

}  // namespace troupe
