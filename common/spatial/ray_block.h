// Rays against bodies in single precision, many at a time by vector instructions, with a margin that makes up for the
// rounding: finds the few pairs of a ray and a body that have to be looked at.
//
// The first of two stages: this one throws away pairs that are surely apart, by discs; ray_cast.cc tests the others
// exactly, in double precision. Invariant: no pair with a hit is thrown away, whatever the rounding, so that the result
// of a cast does not depend on the instructions that a processor has.
//
// A block is up to 16 neighbouring rays of a fan. Their discs and origins are relative to a common place near them: a
// float has 24 bits, of which a world of kilometres would leave too few.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/instructions.h"
#include "common/spatial/disc_list.h"
#include "troupe/vec2.h"

namespace troupe {

// Up to 16 rays.
class RayBlock {
 public:
  static constexpr std::size_t kLanes = DiscList::kLanes;

  // The part of a ray that counts; its origin is relative to the same place near it as the discs, so that differences
  // are exact enough wherever in the world they are.
  struct Part {
    Vec2 origin;     // m
    Vec2 direction;  // of length 1
    double length;   // m
  };
  // A disc, and the rays, a bit for each, that may reach it before they end.
  struct Touched {
    std::uint32_t disc;
    std::uint32_t rays;
  };
  using Lanes = std::array<float, kLanes>;
  struct alignas(64) Numbers {
    Lanes dx{};  // directions
    Lanes dy{};
    Lanes across{};  // m, of the lines, left of the reference
    Lanes start{};   // m, the rays' starts along their directions
    Lanes length{};  // m
    // A box around the rays. It lies along one of them, so that it is narrow if they are a part of a fan.
    float cos = 1.0f;  // of its direction
    float sin = 0.0f;
    float x = 0.0f;  // m, its middle
    float y = 0.0f;
    float half_width = 0.0f;
    float half_height = 0.0f;
    float spread = 0.0f;           // m, at least the lengths above
    std::uint32_t used_lanes = 0;  // a bit for each lane with a ray
  };

  // `max_radius`: no disc has a larger one. REQUIRES: 1 to 16 rays
  RayBlock(std::span<const Part> rays, double max_radius);

  // Replaces `touched` by the discs that any of the rays may reach, in order.
  void FindTouched(const DiscList& discs, std::vector<Touched>& touched) const;

  // Writes the discs to `touched`, which has room for all lanes of the list, and returns their number.
  using Finder = std::size_t(const Numbers& rays, const DiscList& discs, Touched* touched);
  // The variants that this processor can run, the quickest last. They differ only in pairs that are too near to tell.
  static std::span<const Variant<Finder>> Finders();
  void FindTouched(const DiscList& discs, std::vector<Touched>& touched, Finder* finder) const;

  // A lower bound of the way along the ray to the disc, m.
  float WayTo(const DiscList& discs, std::uint32_t disc, std::uint32_t ray) const {
    const DiscList::Group& group = discs.group(disc / kLanes);
    const std::uint32_t lane = disc % kLanes;
    const float x = group.x[lane];
    const float y = group.y[lane];
    return numbers_.dx[ray] * x + numbers_.dy[ray] * y - numbers_.start[ray] -
           Widened(group.radius[lane], x, y, numbers_.spread);
  }

  static float Widened(float radius, float x, float y, float spread) {
    constexpr float kRounding = 1e-6f;  // several times that of a float
    return radius + kRounding * (radius + std::abs(x) + std::abs(y) + 3.0f * spread);
  }

 private:
  Numbers numbers_;
};

}  // namespace troupe
