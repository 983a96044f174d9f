// What the parts that build a world share. Private to this folder.
#pragma once

#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/worldfile/bitmap_rectangles.h"
#include "common/worldfile/build_world.h"
#include "common/worldfile/diagnostics.h"
#include "common/worldfile/property_reader.h"

namespace troupe {

// Keeps each geometry once: models made from one macro share their shape.
class ShapeStore {
 public:
  explicit ShapeStore(std::vector<Shape>& shapes) : shapes_(shapes) {}

  // The id of a shape equal to this one, which is added if there is none.
  ShapeId Add(Shape shape);

 private:
  std::vector<Shape>& shapes_;
  std::multimap<std::uint64_t, ShapeId> by_hash_;
};

struct BuildContext {
  BuildContext(const WorldTree& the_tree, const LoadOverrides& the_overrides, const BuildOptions& the_options)
      : tree(the_tree), overrides(the_overrides), options(the_options), shapes(loaded.world.shapes) {}

  const WorldTree& tree;
  const LoadOverrides& overrides;
  const BuildOptions& options;
  Units units;
  Diagnostics diagnostics;
  LoadedWorld loaded;
  ShapeStore shapes;
  BitmapCache bitmaps;
};

}  // namespace troupe
