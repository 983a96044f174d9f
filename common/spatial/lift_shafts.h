// The shafts of lifts, as obstacles for what is placed in a world. A shaft is as wide as its cabin, and goes from the
// lowest floor of the lift to the top of the cabin at the highest one.
//
// No static model is there: a body that is placed in a shaft stands in the air, or on a floor without a hole, and the
// cabin stops at it for the rest of the run. In the cabin, and above one without walls and a ceiling, there is room.
#pragma once

#include <span>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "troupe/world_description.h"

namespace troupe {

// The parts of all shafts below and above their cabins, in W, as pieces of the lifts' models. `cabins`: by lift, the
// heights of the cabins (m, W).
std::vector<ConvexPiece> EmptyShafts(const WorldDescription& world, std::span<const double> cabins);

// The same with the cabins where they are at load.
std::vector<ConvexPiece> EmptyShafts(const WorldDescription& world);

}  // namespace troupe
