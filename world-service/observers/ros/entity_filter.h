// The filters of requests that list entities.
#pragma once

#include <re2/re2.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ros/connection/simulation_types.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "troupe/polygon.h"
#include "troupe/result.h"
#include "troupe/z_range.h"

namespace troupe {

// By bounds in the world: a box along its axes, a sphere, or the convex hull of points, as a prism over the hull of
// their positions on the ground.
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

class TagsFilter {
 public:
  TagsFilter() = default;
  explicit TagsFilter(const simulation_interfaces_msg_dds__TagsFilter_& filter)
      : tags_(dds::Strings(filter.tags)), needs_all_(filter.filter_mode == 1) {}

  // A filter without tags matches everything.
  bool Matches(const std::vector<std::string>& tags) const {
    const auto has = [&](const std::string& tag) { return std::find(tags.begin(), tags.end(), tag) != tags.end(); };
    if (tags_.empty()) return true;
    return needs_all_ ? std::all_of(tags_.begin(), tags_.end(), has) : std::any_of(tags_.begin(), tags_.end(), has);
  }

 private:
  std::vector<std::string> tags_;
  bool needs_all_ = false;
};

// As in simulation_interfaces/msg/EntityCategory.
std::uint8_t CategoryOf(EntityKind kind);

// By all properties of an entity.
class EntityFilter {
 public:
  // Fails on bounds that are not valid, and on an expression that is not.
  static Result<EntityFilter> Make(const simulation_interfaces_msg_dds__EntityFilters_& filters);

  // Whether Matches needs the boxes of the entities.
  bool has_bounds() const { return bounds_.has_value(); }

  // A filter without categories matches robots and objects; static models match only by their category. `category` and
  // `tags`: of the entity's info.
  bool Matches(const std::string& ros_name, const EntityReport& entity, std::uint8_t category,
               const std::vector<std::string>& tags) const;

 private:
  // Null: every name. RE2, because any peer may send an expression and the time and memory of RE2 are bounded.
  std::unique_ptr<const re2::RE2> expression_;
  std::vector<std::uint8_t> categories_;
  TagsFilter tags_;
  std::optional<BoundsFilter> bounds_;
};

}  // namespace troupe
