// Stage's rules for fitting a body to its model's size and origin.
#pragma once

#include "common/geometry/pose.h"
#include "common/model/world_description.h"

namespace troupe {

// A model's size, m.
struct Size {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

// Stretches the whole shape so that its bounding box is size.x by size.y, centred on the frame's origin, and scales z
// by size.z / (its whole height); z is not shifted: what starts above the ground still does. A shape without extent
// along an axis keeps its coordinates there.
void ScaleToSize(const Size& size, Shape& shape);

// Moves a shape from the body's frame to the model's. Rectangles that do not stay along the axes become blocks.
void MoveByOrigin(const Pose& origin, Shape& shape);

// A box centred on the frame's origin.
Block BoxBlock(const Rectangle& area, const ZRange& z);

}  // namespace troupe
