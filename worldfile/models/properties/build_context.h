// BuildContext: the world being built, and the input that all readers need.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "troupe/world_description.h"
#include "worldfile/map/bitmap_rectangles.h"
#include "worldfile/models/properties/property_reader.h"
#include "worldfile/stage/world_tree.h"
#include "worldfile/text/diagnostics.h"

namespace troupe {

// The full names of a world's models, and where each was given.
class ModelNames {
 public:
  // The full name of a model that `node` makes: `name`, with a number if it is not new. One that is too long is an
  // error.
  std::string Add(const WorldNode& node, const std::string& name, Diagnostics& diagnostics);
  // The same of a part that the model at `where` has by itself; a name that is not new is an error.
  void AddPart(const SourceLocation& where, const std::string& name, Diagnostics& diagnostics);

 private:
  FreeNames free_;
  std::map<std::string, SourceLocation> places_;
};

// Keeps each geometry once, so that models made from one macro share their shape.
class ShapeStore {
 public:
  // `shapes` must outlive the store.
  explicit ShapeStore(std::vector<Shape>& shapes) : shapes_(shapes) {}

  // The id of a shape equal to this one, which is added if there is none.
  ShapeId Add(Shape shape);

 private:
  std::vector<Shape>& shapes_;
  std::multimap<std::uint64_t, ShapeId> by_hash_;
};

// A controller of a property `ctrl` (stage_controllers.h).
struct StageController {
  std::optional<ControllerDescription> description;  // nothing: it cannot be used, as a warning says
  std::vector<std::string> warnings;
};

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
  std::map<std::string, std::optional<StageController>> controllers;  // by the text of `ctrl`
  Units units;
  Diagnostics diagnostics;
  WorldDescription world;
  ShapeStore shapes;
  ModelNames names;
  BitmapCache bitmaps;
};

}  // namespace troupe
