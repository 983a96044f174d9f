#include "world-service/observers/ros/request_values.h"

#include <cmath>
#include <utility>

#include "ros/messages/names.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kMaxTilt = 1e-3;  // of a unit quaternion's x and y: room for rounding

// As in simulation_interfaces/msg/Bounds.
constexpr std::uint8_t kBox = 1;
constexpr std::uint8_t kConvexHull = 2;
constexpr std::uint8_t kSphere = 3;

double Cross(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// Counter-clockwise, without points inside.
std::vector<Vec2> HullOf(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  std::vector<Vec2> hull;
  const auto add = [&](const Vec2& point, std::size_t fixed) {
    while (hull.size() >= fixed + 2 && Cross(hull[hull.size() - 2], hull.back(), point) <= 0.0) hull.pop_back();
    hull.push_back(point);
  };
  for (const Vec2& point : points) add(point, 0);
  const std::size_t lower = hull.size() - 1;
  for (auto point = points.rbegin() + 1; point < points.rend(); ++point) add(*point, lower);
  if (hull.size() > 1) hull.pop_back();
  return hull;
}

// Whether a line along an edge of `a` separates it from `b`.
bool EdgeSeparates(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec2& from = a[i];
    const Vec2& to = a[(i + 1) % a.size()];
    if (std::all_of(b.begin(), b.end(), [&](const Vec2& p) { return Cross(from, to, p) < 0.0; })) return true;
  }
  return false;
}

std::vector<Vec2> FootprintOf(const EntityReport& entity) {
  const Transform2 X_WE(entity.X_WE);
  std::vector<Vec2> footprint;
  for (const Vec2& corner : Corners(entity.box.area)) footprint.push_back(X_WE * corner);
  return footprint;
}

}  // namespace

Result<Pose> PoseFromRos(const char* frame, const ros::PoseMessage& pose) {
  const std::string name = dds::Text(frame);
  if (!name.empty() && name != ros::kMapFrame && name != "world") {
    return Error{{}, "found a pose in frame '" + Shown(name) + "', expected one in '" + ros::kMapFrame + "'"};
  }
  const auto& q = pose.orientation;
  const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!std::isfinite(norm) || !std::isfinite(pose.position.x) || !std::isfinite(pose.position.y) ||
      !std::isfinite(pose.position.z)) {
    return Error{{}, "found a pose that is not finite"};
  }
  if (norm < 1e-6) return Error{{}, "found an orientation of zeros, expected a quaternion"};
  if (std::abs(q.x) > kMaxTilt * norm || std::abs(q.y) > kMaxTilt * norm) {
    return Error{{}, "found a tilted pose, expected one that is upright"};
  }
  return Pose{pose.position.x, pose.position.y, pose.position.z, WrapAngle(2.0 * Atan2(q.z, q.w))};
}

Result<Twist> TwistFromRos(const ros::TwistMessage& twist) {
  for (const double number :
       {twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y, twist.angular.z}) {
    if (!std::isfinite(number)) return Error{{}, "found a twist that is not finite"};
  }
  if (twist.linear.z != 0.0 || twist.angular.x != 0.0 || twist.angular.y != 0.0) {
    return Error{{}, "found a twist out of the ground, expected linear x and y and angular z"};
  }
  return Twist{twist.linear.x, twist.linear.y, twist.angular.z};
}

Result<BoundsFilter> BoundsFilter::Make(const simulation_interfaces_msg_dds__Bounds_& bounds) {
  const auto points = dds::Elements(bounds.points);
  if (bounds.type != kBox && bounds.type != kConvexHull && bounds.type != kSphere) {
    return Error{{}, "found bounds of type " + std::to_string(bounds.type) + ", expected 0 to 3"};
  }
  const bool enough = bounds.type == kConvexHull ? points.size() >= 3 : points.size() == 2;
  if (!enough) {
    return Error{{},
                 "found bounds with " + std::to_string(points.size()) + " points, expected " +
                     (bounds.type == kConvexHull ? "at least 3" : "2")};
  }
  for (const auto& point : points) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) {
      return Error{{}, "found bounds with a point that is not finite"};
    }
  }
  BoundsFilter filter;
  if (bounds.type == kSphere) {
    filter.sphere_ = Sphere{{points[0].x, points[0].y, points[0].z}, points[1].x};
    return filter;
  }
  std::vector<Vec2> positions;
  filter.z_ = {points[0].z, points[0].z};
  for (const auto& point : points) {
    positions.emplace_back(point.x, point.y);
    filter.z_ = {std::min(filter.z_.min, point.z), std::max(filter.z_.max, point.z)};
  }
  if (bounds.type == kBox) {
    positions.emplace_back(points[0].x, points[1].y);
    positions.emplace_back(points[1].x, points[0].y);
  }
  filter.outline_ = HullOf(std::move(positions));
  return filter;
}

bool BoundsFilter::TouchesSphere(const EntityReport& entity) const {
  const auto& [x, y, z] = sphere_->center;
  const Vec2 center = Transform2(entity.X_WE).InverseTransform({x, y});
  const auto& [area, heights] = entity.box;
  const double dx = center.x() - std::clamp(center.x(), area.min_x, area.max_x);
  const double dy = center.y() - std::clamp(center.y(), area.min_y, area.max_y);
  const double height = z - entity.X_WE.z;
  const double dz = height - std::clamp(height, heights.min, heights.max);
  return dx * dx + dy * dy + dz * dz <= sphere_->radius * sphere_->radius;
}

bool BoundsFilter::Overlaps(const EntityReport& entity) const {
  if (entity.box == EntityBox()) return false;
  if (sphere_) return TouchesSphere(entity);
  if (entity.X_WE.z + entity.box.z.min > z_.max || entity.X_WE.z + entity.box.z.max < z_.min) return false;
  const std::vector<Vec2> footprint = FootprintOf(entity);
  return !EdgeSeparates(footprint, outline_) && !EdgeSeparates(outline_, footprint);
}

constexpr std::uint8_t kStaticObject = 5;

std::uint8_t CategoryOf(EntityKind kind) {
  switch (kind) {
    case EntityKind::kRobot:
      return 1;
    case EntityKind::kObject:
      return 4;  // dynamic object
    case EntityKind::kModel:
      return kStaticObject;
    case EntityKind::kPerson:
      return 2;  // human
  }
  return 0;
}

Result<EntityFilter> EntityFilter::Make(const simulation_interfaces_msg_dds__EntityFilters_& filters) {
  EntityFilter filter;
  filter.tags_ = TagsFilter(filters.tags);
  if (filters.bounds.type != 0) {
    Result<BoundsFilter> bounds = BoundsFilter::Make(filters.bounds);
    if (!bounds.ok()) return bounds.error();
    filter.bounds_ = std::move(bounds).value();
  }
  for (const auto& category : dds::Elements(filters.categories)) filter.categories_.push_back(category.category);
  const std::string text = dds::Text(filters.filter);
  if (text.empty()) return filter;
  re2::RE2::Options options;
  options.set_log_errors(false);
  auto expression = std::make_unique<const re2::RE2>(text, options);
  if (!expression->ok()) {
    return Error{
        {}, "found the filter '" + Shown(text) + "', expected a regular expression: " + Shown(expression->error())};
  }
  filter.expression_ = std::move(expression);
  return filter;
}

bool EntityFilter::Matches(const std::string& ros_name, const EntityReport& entity, std::uint8_t category,
                           const std::vector<std::string>& tags) const {
  if (categories_.empty() && entity.kind == EntityKind::kModel) return false;
  const auto listed = std::find(categories_.begin(), categories_.end(), category);
  if (!categories_.empty() && listed == categories_.end()) return false;
  if (!tags_.Matches(tags) || (bounds_ && !bounds_->Overlaps(entity))) return false;
  return expression_ == nullptr || re2::RE2::PartialMatch(ros_name, *expression_);
}

}  // namespace troupe
