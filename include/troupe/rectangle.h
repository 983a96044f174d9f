// An axis-aligned rectangle [min, max], in metres: a piece of a bitmap, and the bounding box of anything.
//
// "Nothing" is the empty rectangle, to which points are added (Extend). Overlaps of bounding boxes are necessary, never
// sufficient: exact tests follow.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "troupe/fields.h"
#include "troupe/vec2.h"

namespace troupe {

struct Rectangle {
  double min_x = 0.0;
  double min_y = 0.0;
  double max_x = 0.0;
  double max_y = 0.0;

  // The bounding box of nothing: extending it by a point gives that point.
  static Rectangle Nothing() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    return {inf, inf, -inf, -inf};
  }
  // The square with sides of twice the reach.
  static Rectangle Around(const Vec2& center, double reach) {
    return {center.x() - reach, center.y() - reach, center.x() + reach, center.y() + reach};
  }
  bool empty() const { return min_x > max_x; }
  void Extend(const Vec2& p) {
    min_x = std::min(min_x, p.x());
    min_y = std::min(min_y, p.y());
    max_x = std::max(max_x, p.x());
    max_y = std::max(max_y, p.y());
  }
  void Extend(const Rectangle& r) {
    min_x = std::min(min_x, r.min_x);
    min_y = std::min(min_y, r.min_y);
    max_x = std::max(max_x, r.max_x);
    max_y = std::max(max_y, r.max_y);
  }
  Rectangle Inflated(double margin) const { return {min_x - margin, min_y - margin, max_x + margin, max_y + margin}; }
  bool Overlaps(const Rectangle& r) const {  // touching counts
    return min_x <= r.max_x && r.min_x <= max_x && min_y <= r.max_y && r.min_y <= max_y;
  }
  bool Contains(const Vec2& p) const { return p.x() >= min_x && p.x() <= max_x && p.y() >= min_y && p.y() <= max_y; }
  double width() const { return max_x - min_x; }
  double height() const { return max_y - min_y; }
  Vec2 center() const { return {0.5 * (min_x + max_x), 0.5 * (min_y + max_y)}; }
  bool operator==(const Rectangle&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"min_x", &Rectangle::min_x}.In("m"),
        Field{"min_y", &Rectangle::min_y}.In("m"),
        Field{"max_x", &Rectangle::max_x}.In("m"),
        Field{"max_y", &Rectangle::max_y}.In("m"),
    };
  }
};

// Counter-clockwise from the one with the smallest coordinates.
inline std::array<Vec2, 4> Corners(const Rectangle& r) {
  return {Vec2(r.min_x, r.min_y), Vec2(r.max_x, r.min_y), Vec2(r.max_x, r.max_y), Vec2(r.min_x, r.max_y)};
}

}  // namespace troupe
