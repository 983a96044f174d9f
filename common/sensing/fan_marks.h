// The place where a sensor with a field of view looks, as a mark. Private to this folder.
#pragma once

#include "common/model/mark.h"
#include "troupe/deterministic_math.h"
#include "troupe/pose.h"

namespace troupe {

// The sector of radius `range` (m) around the x axis of S.
inline Mark SectorMark(const Pose& X_WS, double fov, double range) {
  constexpr int kSteps = 32;
  Mark mark{MarkShape::kArea, MarkRole::kReach, X_WS.z, {X_WS.translation()}};
  for (int i = 0; i <= kSteps; ++i) {
    const SinCosResult at = SinCos(X_WS.heading + fov * (static_cast<double>(i) / kSteps - 0.5));
    mark.points.push_back(X_WS.translation() + range * Vec2(at.cos, at.sin));
  }
  return mark;
}

}  // namespace troupe
