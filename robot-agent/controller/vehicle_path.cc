#include "robot-agent/controller/vehicle_path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "fleet/order_check.h"

namespace troupe {
namespace {

constexpr std::size_t kStepsOfSpan = 32;
constexpr double kShortest = 1e-6;  // m, between points

struct Homogeneous {
  double x = 0.0;
  double y = 0.0;
  double w = 1.0;
};

Homogeneous Between(const Homogeneous& a, const Homogeneous& b, double share) {
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.w + share * (b.w - a.w)};
}

// At parameter u of the span from knot `span` to the next one.
Vec2 PointOfCurve(const std::vector<Homogeneous>& points, const std::vector<double>& knots, std::size_t degree,
                  std::size_t span, double u) {
  std::vector<Homogeneous> d(points.begin() + static_cast<std::ptrdiff_t>(span - degree),
                             points.begin() + static_cast<std::ptrdiff_t>(span + 1));
  for (std::size_t r = 1; r <= degree; ++r) {
    for (std::size_t j = degree; j >= r; --j) {
      const double low = knots[span - degree + j];
      const double high = knots[span + 1 + j - r];
      d[j] = Between(d[j - 1], d[j], high > low ? (u - low) / (high - low) : 0.0);
    }
  }
  return {d[degree].x / d[degree].w, d[degree].y / d[degree].w};
}

}  // namespace

VehiclePath::VehiclePath(const std::vector<Vec2>& points) {
  for (const Vec2& point : points) {
    const double step = points_.empty() ? 0.0 : (point - points_.back()).norm();
    if (!points_.empty() && step < kShortest) continue;
    along_.push_back(points_.empty() ? 0.0 : along_.back() + step);
    points_.push_back(point);
  }
}

std::size_t VehiclePath::SegmentAt(double along) const {
  const auto after = std::upper_bound(along_.begin(), along_.end(), along);
  const auto number = static_cast<std::size_t>(after - along_.begin());
  return std::min(number == 0 ? 0 : number - 1, points_.size() - 2);
}

Vec2 VehiclePath::At(double along) const {
  if (points_.size() < 2) return points_.front();
  const std::size_t i = SegmentAt(along);
  const double share = (along - along_[i]) / (along_[i + 1] - along_[i]);
  return points_[i] + share * (points_[i + 1] - points_[i]);
}

Vec2 VehiclePath::DirectionAt(double along) const {
  if (points_.size() < 2) return Vec2::Zero();
  const std::size_t i = SegmentAt(along);
  return (points_[i + 1] - points_[i]) / (along_[i + 1] - along_[i]);
}

void VehiclePath::AddRest(double along, std::vector<Vec2>& points) const {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (along_[i] > along || i + 1 == points_.size()) points.push_back(points_[i]);
  }
}

double VehiclePath::Nearest(const Vec2& p, double from, double to) const {
  if (points_.size() < 2) return 0.0;
  double best = std::clamp(from, 0.0, length());
  double least = (At(best) - p).squaredNorm();
  for (std::size_t i = SegmentAt(best); i + 1 < points_.size() && along_[i] <= to; ++i) {
    const double segment = along_[i + 1] - along_[i];
    const Vec2 direction = (points_[i + 1] - points_[i]) / segment;
    const double most = std::min(along_[i + 1], to);
    const double at = std::clamp(along_[i] + (p - points_[i]).dot(direction), std::min(best, most), most);
    const double distance = (At(at) - p).squaredNorm();
    if (distance < least) {
      least = distance;
      best = at;
    }
  }
  return best;
}

std::vector<Vec2> PointsOf(const fleet::Trajectory& trajectory) {
  const std::size_t degree = fleet::DegreeOf(trajectory);
  const std::vector<double> knots = fleet::KnotsOf(trajectory);
  std::vector<Homogeneous> points;
  for (const fleet::ControlPoint& point : trajectory.control_points) {
    const double w = point.weight.value_or(1.0);
    points.push_back({point.x * w, point.y * w, w});
  }
  std::vector<Vec2> curve;
  for (std::size_t span = degree; span < points.size(); ++span) {
    if (!(knots[span + 1] > knots[span])) continue;
    for (std::size_t k = curve.empty() ? 0 : 1; k <= kStepsOfSpan; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(kStepsOfSpan);
      const double u = knots[span] + share * (knots[span + 1] - knots[span]);
      curve.push_back(PointOfCurve(points, knots, degree, span, u));
    }
  }
  return curve;
}

}  // namespace troupe
