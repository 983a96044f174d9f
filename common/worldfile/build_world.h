// From a WorldTree to a world: gives every property its meaning, in SI units, with Stage's defaults.
#pragma once

#include "common/base/result.h"
#include "common/worldfile/load_world.h"
#include "common/worldfile/world_tree.h"

namespace troupe {

// Every property of every entity is either honoured or named in a warning with its place; models of types whose
// behaviour is not simulated load as bodies, with a warning.
Result<LoadedWorld> BuildWorld(const WorldTree& tree);

}  // namespace troupe
