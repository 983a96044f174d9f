// The body of a model: its bitmap, its boundary, its blocks or the box that it starts as, scaled to its size.
//
// Frames: D, in which the file declares blocks and pixels; M, the model's own. A body is stretched to the size of the
// model and centred on the origin of D, then moved by X_MD (`origin`). So a block's coordinates are proportions only,
// as in Stage; a ROS map is the exception, whose pixels are metres already.
//
// Bodies that move are lists of convex pieces or rectangles; only bodies at rest may be pixel areas (map_yaml.h). Every
// shape of ReadModelShape and RosMapShape satisfies the checks of a world (common/model): normalized outlines, no flat
// blocks, all coordinates within 1000 km; otherwise it is empty and the diagnostics have the error.
#pragma once

#include <optional>

#include "troupe/pose.h"
#include "troupe/world_description.h"
#include "worldfile/models/properties/property_reader.h"

namespace troupe {

// Stage's rules that fit a body to its model's size and origin.

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

// A ROS map, or a map of cells, as the property `map_yaml` or `map_cells` gives it to a model.
struct RosMap {
  Pose origin;  // of the image's lower left corner, in the parent's frame
  Size size;    // m
  const BitmapRectangles* pixels = nullptr;
  double resolution = 0.0;  // m, width and height of a pixel

  MapGrid grid() const {
    return {static_cast<std::uint32_t>(pixels->width), static_cast<std::uint32_t>(pixels->height), resolution};
  }
};

// The map of the property `map_yaml` or `map_cells`; nothing if there is none, or it cannot be read. Valid as long as
// the context.
std::optional<RosMap> ReadRosMap(PropertyReader& reader, BuildContext& context);

// A moving model's shape, with the rectangles of its bitmap in a list. More than kMaxMovingRectangles of a dense bitmap
// are an error of the file: a body that moves is tested piece by piece.
Shape ListedForMotion(PropertyReader& reader, Shape shape);

// The map's body in the model's frame M: walls of height size.z, the image's lower left corner at X_MD.
Shape RosMapShape(PropertyReader& reader, const RosMap& map, const Size& size, const Pose& X_MD);

// The body of the reader's model in its frame M; its blocks are declared in frame D. `has_box`: without bitmap and
// blocks the body is a box of the model's size.
Shape ReadModelShape(PropertyReader& reader, bool has_box, const Size& size, const Pose& X_MD, BuildContext& context);

}  // namespace troupe
