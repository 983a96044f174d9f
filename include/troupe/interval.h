// Interval: a closed range of numbers.
//
// Both ends belong to it. REQUIRES min <= max where nothing else is said; FieldCheck refuses other ones at the borders
// of the program.
#pragma once

#include "troupe/fields.h"

namespace troupe {

struct Interval {
  double min = 0.0;
  double max = 0.0;
  double Clamp(double value) const { return value < min ? min : (value > max ? max : value); }
  bool Contains(double value) const { return value >= min && value <= max; }
  bool operator==(const Interval&) const = default;
  static constexpr auto Fields() { return std::tuple{Field{"min", &Interval::min}, Field{"max", &Interval::max}}; }
};

}  // namespace troupe
