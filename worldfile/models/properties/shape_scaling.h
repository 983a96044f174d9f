// Stage's rules that fit a body to its model's size and origin.
#pragma once

#include "troupe/pose.h"
#include "troupe/world_description.h"

namespace troupe {

// A model's size, m.
struct Size {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

// The shape stretched so that its bounding box is size.x by size.y, centred on the frame's origin, with z scaled by
// size.z / (its whole height). z is not shifted: a gap below the shape is scaled, too. A shape without extent along an
// axis keeps its coordinates there.
Shape ScaledToSize(Shape shape, const Size& size);

// A declared shape (frame D) in the model's frame M. Rectangles that X_MD turns away from the axes become blocks.
Shape Moved(Shape shape, const Pose& X_MD);

// A block whose outline is a rectangle.
Block BoxBlock(const Rectangle& area, const ZRange& z);

}  // namespace troupe
