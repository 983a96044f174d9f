// Reads a `block` of a world file.
#pragma once

#include <optional>

#include "troupe/world_description.h"
#include "worldfile/models/properties/property_reader.h"

namespace troupe {

// The block in the file's coordinates, its outline normalized; nothing if it is wrong, which is then reported.
std::optional<Block> ReadBlock(const WorldNode& node, const Units& units, Diagnostics& diagnostics);

}  // namespace troupe
