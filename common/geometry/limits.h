// The largest numbers of a world.
#pragma once

namespace troupe {

// No coordinate, size or speed of a world is larger, in m, rad and s: beyond it a double has no room left for the touch
// tolerance (z_range.h).
inline constexpr double kMaxMagnitude = 1e6;

}  // namespace troupe
