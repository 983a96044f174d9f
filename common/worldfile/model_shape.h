// The body of a model: its bitmap, its boundary, its blocks or the box that it starts as, scaled to its size. Private
// to this folder.
#pragma once

#include <optional>

#include "common/worldfile/build_context.h"
#include "common/worldfile/property_catalogue.h"

namespace troupe {

// What a ROS map says of the model that names it by the property `map_yaml`.
struct RosMap {
  Pose origin;  // of the image's lower left corner, in the parent's frame
  Size size;    // m
  const BitmapRectangles* pixels = nullptr;
  double resolution = 0.0;  // m
};

// The map of the property `map_yaml`; nothing if there is none, or it cannot be read.
std::optional<RosMap> ReadRosMap(PropertyReader& reader, BuildContext& context);

// The map's body: walls of the model's height, the image's lower left corner at the model's pose.
Shape RosMapShape(PropertyReader& reader, const RosMap& map, const Size& size, const Pose& origin);

// The body of the reader's model in its frame M. `origin` is the body's pose in M.
Shape ReadModelShape(PropertyReader& reader, const TypeDefaults& type, const Size& size, const Pose& origin,
                     BuildContext& context);

}  // namespace troupe
