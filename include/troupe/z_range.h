// A height interval [min, max), in metres.
#pragma once

#include <algorithm>

namespace troupe {

// Lengths and depths up to this count as touching, not as overlapping: it absorbs rounding, and is far below anything
// that a sensor or a picture could show.
inline constexpr double kTouchTolerance = 1e-9;  // m

struct ZRange {
  double min = 0.0;  // m
  double max = 0.0;  // m

  bool Contains(double z) const { return z >= min && z < max; }
  // True if the intervals share a length; touching intervals and empty ones do not.
  bool Overlaps(const ZRange& other) const {
    return std::min(max, other.max) - std::max(min, other.min) > kTouchTolerance;
  }
  ZRange operator+(double dz) const { return {min + dz, max + dz}; }
  bool operator==(const ZRange&) const = default;
};

}  // namespace troupe
