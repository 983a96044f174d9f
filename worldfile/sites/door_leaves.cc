#include "worldfile/sites/door_leaves.h"

#include <algorithm>
#include <cmath>

#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kLeafGap = 0.01;  // m, between the widths of a leaf and of its part of the doorway

// A leaf that extends from its hinge by `width` to the side of the sign of `width`.
DoorLeaf HingedLeaf(const Pose& X_WD, double hinge, double width, double turn) {
  const double near = std::copysign(0.5 * kLeafGap, width);
  const double far = std::copysign(std::max(std::fabs(width) - 0.5 * kLeafGap, kLeafGap), width);
  return {X_WD * Pose{hinge, 0.0, 0.0, 0.0}, std::min(near, far), std::max(near, far), turn, 0.0};
}

}  // namespace

DoorLeaf SlidingLeaf(const Pose& X_WD, double middle, double width, double shift) {
  const double half = 0.5 * std::max(width - kLeafGap, kLeafGap);
  return {X_WD * Pose{middle, 0.0, 0.0, 0.0}, -half, half, 0.0, shift};
}

Pose DoorLeaf::X_WH_open() const {
  return X_WH * Pose{shift, 0.0, 0.0, WrapAngle(turn)};
}

std::vector<DoorLeaf> LeavesOf(const SiteDoor& door, const std::vector<SiteVertex>& vertices, double elevation) {
  const Vec2& start = vertices[door.edge.start].position;
  const Vec2& end = vertices[door.edge.end].position;
  const Vec2 middle = 0.5 * (start + end);
  // Frame D: at the middle of the doorway, x towards the start.
  const Pose X_WD{middle.x(), middle.y(), elevation, Atan2(start.y() - end.y(), start.x() - end.x())};
  const double length = (end - start).norm();
  const double right = door.right_left_ratio / (1.0 + door.right_left_ratio) * length;
  const double left = length - right;
  const double turn = door.opens_clockwise ? -door.swing : door.swing;  // of a leaf whose hinge is at the start
  switch (door.kind) {
    case SiteDoorKind::kHinged:
      if (door.hinge_at_end) return {HingedLeaf(X_WD, -0.5 * length, length, -turn)};
      return {HingedLeaf(X_WD, 0.5 * length, -length, turn)};
    case SiteDoorKind::kDoubleHinged:
      return {HingedLeaf(X_WD, 0.5 * length, -right, turn), HingedLeaf(X_WD, -0.5 * length, left, -turn)};
    case SiteDoorKind::kSliding:
      return {SlidingLeaf(X_WD, 0.0, length, door.hinge_at_end ? -length : length)};
    case SiteDoorKind::kDoubleSliding:
      break;
  }
  return {SlidingLeaf(X_WD, 0.5 * (length - right), right, right),
          SlidingLeaf(X_WD, 0.5 * (left - length), left, -left)};
}

}  // namespace troupe
