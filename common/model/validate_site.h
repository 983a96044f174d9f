// The invariants of the levels and lanes of a world description; see world_description.h.
#pragma once

#include "troupe/result.h"
#include "troupe/world_description.h"

namespace troupe {

Status ValidateSite(const WorldDescription& world);

}  // namespace troupe
