// Color: red, green, blue and opacity.
//
// Each channel from 0 to 1, opacity 1 for opaque. Colours are what blobfinders and cameras measure, so that they are
// doubles with the same bits everywhere, and a part of the hash of a world.
#pragma once

#include "troupe/fields.h"

namespace troupe {

// Red, green, blue, opacity in 0..1.
struct Color {
  double r = 1.0;
  double g = 0.0;
  double b = 0.0;
  double a = 1.0;
  bool operator==(const Color&) const = default;
  static constexpr auto Fields() {
    return std::tuple{Field{"r", &Color::r}, Field{"g", &Color::g}, Field{"b", &Color::b}, Field{"a", &Color::a}};
  }
};

}  // namespace troupe
