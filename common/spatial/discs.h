// Discs in single precision, tested four at a time: for finding the few of many that are near a box.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/spatial/float4.h"
#include "troupe/rectangle.h"
#include "troupe/vec2.h"

namespace troupe {

// The box of a query, along the x axis or any other direction.
class DiscBox {
 public:
  // `box`: m, its x axis being `along`, of length 1. `max_radius`: no disc has a larger one.
  DiscBox(const Rectangle& box, double max_radius, const Vec2& along = Vec2(1.0, 0.0)) {
    // The numbers of a disc that overlaps the box are not larger than those of the box and its radius together, so this
    // makes up for the rounding of both.
    constexpr double kRounding = 2e-6;  // many times that of a float
    const Vec2 center = box.center();
    const double rounding =
        kRounding * (std::abs(center.x()) + std::abs(center.y()) + box.width() + box.height() + max_radius);
    cos_ = static_cast<float>(along.x());
    sin_ = static_cast<float>(along.y());
    x_ = static_cast<float>(center.x());
    y_ = static_cast<float>(center.y());
    half_width_ = static_cast<float>(0.5 * box.width() + rounding);
    half_height_ = static_cast<float>(0.5 * box.height() + rounding);
  }

 private:
  friend class DiscList;
  float cos_;  // of its direction
  float sin_;
  float x_;  // m, its middle
  float y_;
  float half_width_;
  float half_height_;
};

class DiscList {
 public:
  struct Disc {
    float x;  // m
    float y;
    float radius;
  };

  Disc operator[](std::size_t i) const {
    const Group& group = groups_[i / 4];
    return {group.x[i % 4], group.y[i % 4], group.radius[i % 4]};
  }

  void Clear() {
    groups_.clear();
    size_ = 0;
  }
  void Reserve(std::size_t count) { groups_.reserve((count + 3) / 4); }
  void Add(const Vec2& center, double radius) {
    if (size_ % 4 == 0) groups_.push_back(Group{{}, {}, kNoDisc});
    groups_.back().radius[size_ % 4] = static_cast<float>(radius);
    Move(size_++, center);
  }
  void Move(std::size_t i, const Vec2& center) {
    groups_[i / 4].x[i % 4] = static_cast<float>(center.x());
    groups_[i / 4].y[i % 4] = static_cast<float>(center.y());
  }

  // False only if the disc and the box have nothing in common; NaN overlaps. Never wrong by rounding.
  bool Overlaps(std::size_t i, const DiscBox& box) const {
    return (Overlapping(groups_[i / 4], box) >> (i % 4) & 1) != 0;
  }

  // Calls visit(i) for the discs that overlap the box, in order.
  template <typename Visit>
  void ForEachOverlapping(const DiscBox& box, Visit visit) const {
    for (std::size_t group = 0; group < groups_.size(); ++group) {
      for (std::uint32_t lanes = Overlapping(groups_[group], box); lanes != 0; lanes &= lanes - 1) {
        const std::size_t i = 4 * group + static_cast<std::size_t>(std::countr_zero(lanes));
        if (i < size_) visit(i);  // a box without bounds overlaps the lanes without a disc as well
      }
    }
  }

 private:
  struct Group {
    Float4 x;
    Float4 y;
    Float4 radius;
  };
  static constexpr Float4 kNoDisc{-1e30f, -1e30f, -1e30f, -1e30f};  // the radius of lanes without a disc

  static std::uint32_t Overlapping(const Group& discs, const DiscBox& box) {
    const Float4 x = box.cos_ * discs.x + box.sin_ * discs.y - box.x_;
    const Float4 y = box.cos_ * discs.y - box.sin_ * discs.x - box.y_;
    const Float4 reach_x = discs.radius + box.half_width_;
    const Float4 reach_y = discs.radius + box.half_height_;
    return BitsOf(~((x > reach_x) | (x < -reach_x) | (y > reach_y) | (y < -reach_y)));
  }

  std::vector<Group> groups_;
  std::size_t size_ = 0;
};

}  // namespace troupe
