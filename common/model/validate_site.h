// The invariants of the levels and lanes of a world description; see world_description.h. Apart from validate_world.cc,
// because only worlds of buildings have them. Linear in vertices and lanes; indices are checked here once, so that
// planners need not.
#pragma once

#include "troupe/result.h"
#include "troupe/world_description.h"

namespace troupe {

Status ValidateSite(const WorldDescription& world);

}  // namespace troupe
