// Discs in single precision, four at a time: for finding the few of many that are near a box.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "common/geometry/rectangle.h"
#include "common/spatial/float4.h"

namespace troupe {

struct Discs {
  Float4 x;  // m
  Float4 y;
  Float4 radius;

  void Move(std::size_t lane, const Vec2& center) {
    x[lane] = static_cast<float>(center.x());
    y[lane] = static_cast<float>(center.y());
  }
};

// A box for asking which discs overlap it.
class DiscBox {
 public:
  // `max_radius`: no disc has a larger one.
  DiscBox(const Rectangle& box, double max_radius) {
    // The numbers of a disc that overlaps the box are not larger than those of the box and its radius together, so this
    // makes up for the rounding of both.
    constexpr double kRounding = 1e-6;  // many times that of a float
    const Vec2 center = box.center();
    const double rounding =
        kRounding * (std::abs(center.x()) + std::abs(center.y()) + box.width() + box.height() + max_radius);
    x_ = static_cast<float>(center.x());
    y_ = static_cast<float>(center.y());
    half_width_ = static_cast<float>(0.5 * box.width() + rounding);
    half_height_ = static_cast<float>(0.5 * box.height() + rounding);
  }

  // Bit i: disc i overlaps the box, or a number is none. Never wrong by rounding.
  std::uint32_t Overlapping(const Discs& discs) const {
    const Float4 x = discs.x - x_;
    const Float4 y = discs.y - y_;
    const Float4 reach_x = discs.radius + half_width_;
    const Float4 reach_y = discs.radius + half_height_;
    return AllBits(~((x > reach_x) | (x < -reach_x) | (y > reach_y) | (y < -reach_y)) & kLaneBits);
  }

 private:
  float x_;  // m, its middle
  float y_;
  float half_width_;
  float half_height_;
};

}  // namespace troupe
