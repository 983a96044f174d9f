// Mark: a drawing of a part of a reading in the world. Pictures show marks without knowledge of the kind of sensor.
//
// In W, because a picture is of the world; a drawing program needs no pose of a robot. Marks are for eyes only: no
// result depends on them.
#pragma once

#include <cstdint>
#include <vector>

#include "troupe/vec2.h"

namespace troupe {

enum class MarkShape : std::uint8_t {
  kArea,  // the polygon of the points
  kLine,  // through the points
  kDot,   // at each point
};

enum class MarkRole : std::uint8_t {
  kReach,   // a place where the sensor looks
  kFound,   // a finding
  kIdle,    // a part that finds nothing
  kTouched  // a contact
};

struct Mark {
  MarkShape shape = MarkShape::kLine;
  MarkRole role = MarkRole::kFound;
  double z = 0.0;                 // m, in W
  std::vector<Vec2> points = {};  // m, in W
};

}  // namespace troupe
