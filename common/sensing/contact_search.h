// The bodies that touch an outline, for bumpers and contact sensors. Private to this folder.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/sensing/sensor.h"
#include "common/spatial/nearest_points.h"
#include "troupe/z_range.h"

namespace troupe {

// A body at most so far away is in contact: a motion ends within a millimetre of the first contact.
inline constexpr double kContactReach = 1e-3;  // m

struct Touch {
  ModelId other;
  NearestPoints points;  // a: of the outline
  ZRange z;              // m, in W: where both are
};

// The pieces of bodies other than the robot's own, and those that it holds, which collide (obstacle_return), are within
// kContactReach of the convex outline (frame W) and share a length of the heights `z` with it, or its one height if `z`
// is empty.
std::vector<Touch> FindTouches(const SensedWorld& world, RobotId robot, std::span<const Vec2> outline, const ZRange& z);

}  // namespace troupe
