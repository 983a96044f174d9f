// From a WorldTree to a world: gives every property its meaning, in SI units, with Stage's defaults.
#pragma once

#include "common/image/image_source.h"
#include "troupe/result.h"
#include "worldfile/models/loaded_world.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

struct BuildOptions {
  bool without_bitmaps = false;  // a bitmap is an error; for input that must not touch the disk
  ImageSource images = nullptr;  // of images that are not read from their files
};

// Every property of every node is either honoured or named in a warning with its place.
Result<LoadedWorld> BuildWorld(const WorldTree& tree, const LoadOverrides& overrides = {},
                               const BuildOptions& options = {});

}  // namespace troupe
