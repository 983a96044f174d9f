// Color: red, green, blue and opacity.
#pragma once

namespace troupe {

// Red, green, blue, opacity in 0..1.
struct Color {
  double r = 1.0;
  double g = 0.0;
  double b = 0.0;
  double a = 1.0;
  bool operator==(const Color&) const = default;
};

}  // namespace troupe
