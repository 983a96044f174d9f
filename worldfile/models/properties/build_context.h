// BuildContext: the world being built, and the input that all readers need.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "troupe/world_description.h"
#include "worldfile/map/bitmap_rectangles.h"
#include "worldfile/models/properties/model_names.h"
#include "worldfile/models/properties/property_reader.h"
#include "worldfile/models/properties/shape_store.h"
#include "worldfile/stage/world_tree.h"
#include "worldfile/text/diagnostics.h"

namespace troupe {

struct BuildContext {
  BuildContext(const WorldTree& the_tree, const AllowedPaths& the_allowed, const ImageSource& images)
      : tree(the_tree), allowed(the_allowed), shapes(world.shapes), bitmaps(the_allowed, images) {}
  BuildContext(const BuildContext&) = delete;  // `shapes` refers to `world`
  BuildContext& operator=(const BuildContext&) = delete;

  const WorldTree& tree;
  const AllowedPaths& allowed;                    // files that maps and bitmaps may open
  bool without_bitmaps = false;                   // a bitmap is an error
  std::optional<std::string> default_controller;  // of robots for which the file names none
  // Of the controllers that the file names; nothing: they are not checked.
  std::function<Status(const std::string& name, const std::string& parameters)> check_controller;
  Units units;
  Diagnostics diagnostics;
  WorldDescription world;
  ShapeStore shapes;
  ModelNames names;
  BitmapCache bitmaps;
};

}  // namespace troupe
