// Values of ROS requests: poses, twists, paths with their formats, and filters of entities.
//
// Requests come from any peer of the ROS domain. Whatever a message can hold is either converted or refused with a
// reason: numbers that are not finite, zero quaternions, expressions, polygons with any number of points. The
// simulation is planar, so a pose that is tilted about x or y is refused rather than silently flattened.
#pragma once

#include <re2/re2.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/text.h"
#include "ros/connection/topic_types.h"
#include "ros/messages/messages.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "troupe/polygon.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "troupe/z_range.h"

namespace troupe {

// Texts of requests: of any length and content, so that messages show their beginning only.
inline constexpr std::size_t kMaxRequestedName = 200;  // bytes, of what a request names
inline std::string Shown(std::string_view text) {
  return PlainLine(text, kMaxRequestedName);
}

// Values of ROS requests: poses, twists, and paths with their formats.

// X_WE of an entity E. `frame`: "map" or "world", which are one frame; "" means map. Fails on another frame, on a
// number that is not finite, on a quaternion of zeros, and on a pose that is tilted about x or y.
Result<Pose> PoseFromRos(const char* frame, const ros::PoseMessage& pose);

// A twist of a robot in its frame R: the components that a drive has. The error is another component, or a number that
// is not finite.
Result<Twist> TwistFromRos(const ros::TwistMessage& twist);

// The path of a "file://" URI; any other text as it is.
inline std::string ResourcePath(const char* uri) {
  const std::string text = dds::Text(uri);
  constexpr std::string_view kScheme = "file://";
  return text.starts_with(kScheme) ? text.substr(kScheme.size()) : text;
}

// Whether the text of a file has another format than a Stage world or a scenario: XML, as of URDF and SDF.
inline bool IsOtherText(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && text[first] == '<';
}

// Whether a resource that cannot be used has a format other than those with the endings: another ending, or another
// scheme. A name without an ending, as of a model, has none.
inline bool HasOtherFormat(const std::string& path, std::initializer_list<std::string_view> endings) {
  if (path.find("://") != std::string::npos) return true;
  const std::string ending = std::filesystem::path(path.substr(0, path.rfind('#'))).extension().string();
  return !ending.empty() && std::find(endings.begin(), endings.end(), ending) == endings.end();
}

// The filters of requests that list entities.

// Filters by bounds in the world: a box along its axes, a sphere, or the convex hull of points, as a prism over the
// hull of their positions on the ground.
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

// Filters by all properties of an entity.
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
