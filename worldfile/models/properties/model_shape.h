// The body of a model: its bitmap, its boundary, its blocks or the box that it starts as, scaled to its size.
#pragma once

#include <optional>

#include "worldfile/models/properties/build_context.h"
#include "worldfile/models/properties/shape_scaling.h"

namespace troupe {

// A ROS map, as the property `map_yaml` gives it to a model.
struct RosMap {
  Pose origin;  // of the image's lower left corner, in the parent's frame
  Size size;    // m
  const BitmapRectangles* pixels = nullptr;
  double resolution = 0.0;  // m, width and height of a pixel

  MapGrid grid() const {
    return {static_cast<std::uint32_t>(pixels->width), static_cast<std::uint32_t>(pixels->height), resolution};
  }
};

// The map of the property `map_yaml`; nothing if there is none, or it cannot be read. Valid as long as the context.
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
