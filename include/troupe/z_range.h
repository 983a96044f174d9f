// A height interval [min, max), in metres.
//
// Half open, so that a body on a floor does not overlap it: stacked bodies touch at one height and both tests are
// exact. Overlaps needs more than kTouchTolerance in common, because heights are sums with rounding.
#pragma once

#include <algorithm>

#include "troupe/fields.h"

namespace troupe {

// Lengths and depths up to this count as touching, not as overlapping: it absorbs rounding, and is far below anything
// that a sensor or a picture could show.
inline constexpr double kTouchTolerance = 1e-9;  // m

struct ZRange {
  double min = 0.0;
  double max = 0.0;

  bool Contains(double z) const { return z >= min && z < max; }
  // True if the intervals share a length; touching intervals and empty ones do not.
  bool Overlaps(const ZRange& other) const {
    return std::min(max, other.max) - std::max(min, other.min) > kTouchTolerance;
  }
  ZRange operator+(double dz) const { return {min + dz, max + dz}; }
  bool operator==(const ZRange&) const = default;
  static constexpr auto Fields() {
    return std::tuple{Field{"min", &ZRange::min}.In("m"), Field{"max", &ZRange::max}.In("m")};
  }
};

}  // namespace troupe
