// BoundsFilter: the filter of a request by bounds in the world: a box along its axes, a sphere, or the convex hull of
// points, as a prism over the hull of their positions on the ground.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "ros/connection/simulation_types.h"
#include "transport/protocol/messages.h"
#include "troupe/polygon.h"
#include "troupe/result.h"
#include "troupe/z_range.h"

namespace troupe {

class BoundsFilter {
 public:
  // The error is an unknown type, another number of points than the type has, or one that is not finite.
  static Result<BoundsFilter> Make(const simulation_interfaces_msg_dds__Bounds_& bounds);

  // Whether the box of the entity touches the bounds. An entity without a body has no box.
  bool Overlaps(const EntityReport& entity) const;

 private:
  struct Sphere {
    std::array<double, 3> center;  // m
    double radius = 0.0;
  };
  bool TouchesSphere(const EntityReport& entity) const;

  std::optional<Sphere> sphere_;
  std::vector<Vec2> outline_;  // of a prism, convex, counter-clockwise
  ZRange z_;
};

}  // namespace troupe
