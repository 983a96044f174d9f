#include "common/picture/shading.h"

#include <algorithm>
#include <cmath>

namespace troupe {
namespace {

constexpr Color kShadow{0.10, 0.12, 0.16, 1.0};

// Pure screen colours are too loud: reduces their saturation, and a little of their contrast.
Color Soft(const Color& color, double share) {
  const double luma = 0.3 * color.r + 0.59 * color.g + 0.11 * color.b;
  return Mix(Mix(WithOpacity(color, 1.0), {luma, luma, luma, 1.0}, share), {0.5, 0.5, 0.5, 1.0}, 0.10);
}

}  // namespace

Color Mix(const Color& from, const Color& to, double share) {
  const auto mix = [&](double a, double b) { return a + (b - a) * share; };
  return {mix(from.r, to.r), mix(from.g, to.g), mix(from.b, to.b), mix(from.a, to.a)};
}

Color WithOpacity(Color color, double opacity) {
  color.a = opacity;
  return color;
}

Color ObjectColor(const Color& color, double height) {
  const Color soft = Soft(color, 0.26);
  // Most solids are low beside the highest one: the root spreads them over the shades.
  const double share = std::sqrt(std::clamp(height, 0.0, 1.0));
  return Mix(Mix(soft, kShadow, 0.42), Mix(soft, page::kPaper, 0.5), share);
}

Color RobotColor(const Color& color, double height) {
  const Color soft = Soft(color, 0.12);
  return Mix(Mix(soft, kShadow, 0.38), Mix(soft, page::kPaper, 0.14), std::clamp(height, 0.0, 1.0));
}

Color WallColor(const Color& color) {
  return Mix(WithOpacity(color, 1.0), {0.180, 0.215, 0.270, 1.0}, 0.75);
}

Color OutlineColor(const Color& color) {
  return Mix(color, kShadow, 0.55);
}

}  // namespace troupe
