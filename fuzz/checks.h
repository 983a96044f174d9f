// What the targets of world files check of the results of readers.
#pragma once

#include <string>

#include "fuzz/targets.h"
#include "troupe/result.h"
#include "worldfile/stage/world_tree.h"

namespace troupe::fuzz {

// A message has a text, of one line, and a file; a warning and an error in a text a place in it, too.
void CheckError(const Error& error);
void CheckMessage(const SourceLocation& where, const std::string& message);

// A tree becomes a valid world, or an error. `has_places`: of its messages; elements of macros in other files and bytes
// of meshes have a file alone.
void CheckBuilt(const WorldTree& tree, bool has_places = true);

}  // namespace troupe::fuzz
