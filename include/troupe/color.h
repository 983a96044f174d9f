// Color: red, green, blue and opacity.
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
