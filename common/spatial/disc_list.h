// DiscList: discs in single precision, tested several at a time by vector instructions, with a margin that makes up for
// the rounding: for finding the few of many that are near a box.
//
// Invariant: a test may say "overlaps" for a disc that is just outside, never "apart" for one that overlaps: what it
// finds is tested exactly afterwards. Groups of 16 discs are columns of x, y and radius, one line of a cache each.
//
// The order of discs is that of Add; a disc keeps its number when it moves.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/spatial/ray_shape.h"
#include "troupe/rectangle.h"
#include "troupe/vec2.h"

namespace troupe {

// The box of a query.
class DiscBox {
 public:
  // `box`: m. `max_radius`: no disc has a larger one.
  DiscBox(const Rectangle& box, double max_radius) {
    // The numbers of a disc that overlaps the box are not larger than those of the box and its radius together, so this
    // makes up for the rounding of both.
    constexpr double kRounding = 2e-6;  // many times that of a float
    const Vec2 center = box.center();
    const double rounding =
        kRounding * (std::abs(center.x()) + std::abs(center.y()) + box.width() + box.height() + max_radius);
    x = static_cast<float>(center.x());
    y = static_cast<float>(center.y());
    half_width = static_cast<float>(0.5 * box.width() + rounding);
    half_height = static_cast<float>(0.5 * box.height() + rounding);
  }

  float x;  // m, its middle
  float y;
  float half_width;
  float half_height;
};

class DiscList {
 public:
  static constexpr std::size_t kLanes = 16;
  struct alignas(64) Group {
    std::array<float, kLanes> x{};  // m
    std::array<float, kLanes> y{};
    std::array<float, kLanes> radius{};
  };

  void Clear() { size_ = 0; }
  void Add(const Vec2& center, double radius) {
    if (size_ / kLanes == groups_.size()) groups_.emplace_back();
    groups_[size_ / kLanes].radius[size_ % kLanes] = static_cast<float>(radius);
    Move(size_++, center);
  }
  void Move(std::size_t i, const Vec2& center) {
    groups_[i / kLanes].x[i % kLanes] = static_cast<float>(center.x());
    groups_[i / kLanes].y[i % kLanes] = static_cast<float>(center.y());
  }

  std::size_t size() const { return size_; }
  // Disc i is in group i / kLanes. The last group may have lanes without a disc, with any numbers.
  const Group& group(std::size_t number) const { return groups_[number]; }

  // False only if the disc and the box have nothing in common; NaN overlaps. Never wrong by rounding.
  bool Overlaps(std::size_t i, const DiscBox& box) const {
    const Group& group = groups_[i / kLanes];
    const std::size_t lane = i % kLanes;
    const float x = std::abs(group.x[lane] - box.x);
    const float y = std::abs(group.y[lane] - box.y);
    // Negated, so that NaN overlaps: a test of it is left to exact code.
    return !(x > group.radius[lane] + box.half_width || y > group.radius[lane] + box.half_height);
  }

  // Calls visit(i) for the discs that overlap the box, in order.
  template <typename Visit>
  void ForEachOverlapping(const DiscBox& box, Visit visit) const {
    for (std::size_t first = 0; first < size_; first += 4) {
      for (std::uint32_t lanes = FourOverlapping(first, box); lanes != 0; lanes &= lanes - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(lanes));
        if (i < size_) visit(i);
      }
    }
  }

 private:
  // A bit for each of four discs.
  std::uint32_t FourOverlapping(std::size_t first, const DiscBox& box) const {
    const Group& group = groups_[first / kLanes];
    const auto four = [first](const std::array<float, kLanes>& lanes) { return LoadFour(&lanes[first % kLanes]); };
    const Float4 x = four(group.x) - box.x;
    const Float4 y = four(group.y) - box.y;
    const Float4 reach_x = four(group.radius) + box.half_width;
    const Float4 reach_y = four(group.radius) + box.half_height;
    return BitsOf(~((x > reach_x) | (x < -reach_x) | (y > reach_y) | (y < -reach_y)));
  }

  std::vector<Group> groups_;  // at least as many as needed
  std::size_t size_ = 0;
};

}  // namespace troupe
