// Colours of pictures: a pale page, and model colours softened and shaded by height.
#pragma once

#include "troupe/world_description.h"

namespace troupe {

// `from` at 0, `to` at 1.
Color Mix(const Color& from, const Color& to, double share);
Color WithOpacity(Color color, double opacity);

// A model's colour at a height: `height` 0 is the lowest (dark, muted), 1 the highest (light).
Color ObjectColor(const Color& color, double height);
// The same for a part of a robot: stronger, so that robots stand out from their surroundings.
Color RobotColor(const Color& color, double height);
// The walls of a map: dark, with a tinge of its colour.
Color WallColor(const Color& color);
// A line around an area of this colour.
Color OutlineColor(const Color& color);

namespace page {
inline constexpr Color kPaper{1.0, 1.0, 1.0, 1.0};
inline constexpr Color kGround{0.984, 0.988, 0.992, 1.0};
inline constexpr Color kGridMinor{0.945, 0.953, 0.961, 1.0};
inline constexpr Color kGridMajor{0.890, 0.906, 0.922, 1.0};
inline constexpr Color kFrame{0.760, 0.790, 0.820, 1.0};
inline constexpr Color kQuietText{0.440, 0.480, 0.530, 1.0};
inline constexpr Color kText{0.100, 0.130, 0.180, 1.0};
inline constexpr Color kScan{0.180, 0.470, 0.900, 1.0};
inline constexpr Color kStalled{0.860, 0.110, 0.170, 1.0};
}  // namespace page

}  // namespace troupe
