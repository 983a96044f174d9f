// BuildContext: the world being built, and the input that all readers need.
#pragma once

#include <optional>
#include <string>

#include "common/model/world_description.h"
#include "common/worldfile/build/properties/model_names.h"
#include "common/worldfile/build/properties/property_reader.h"
#include "common/worldfile/build/properties/shape_store.h"
#include "common/worldfile/map/bitmap_rectangles.h"
#include "common/worldfile/stage/world_tree.h"
#include "common/worldfile/text/diagnostics.h"

namespace troupe {

struct BuildContext {
  explicit BuildContext(const WorldTree& the_tree) : tree(the_tree), shapes(world.shapes) {}
  BuildContext(const BuildContext&) = delete;  // `shapes` refers to `world`
  BuildContext& operator=(const BuildContext&) = delete;

  const WorldTree& tree;
  bool without_bitmaps = false;                   // a bitmap is an error
  std::optional<std::string> default_controller;  // of robots for which the file names none
  Units units;
  Diagnostics diagnostics;
  WorldDescription world;
  ShapeStore shapes;
  ModelNames names;
  BitmapCache bitmaps;
};

}  // namespace troupe
