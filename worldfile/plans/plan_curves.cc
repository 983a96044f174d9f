#include "worldfile/plans/plan_curves.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/limits.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kShortest = 0.001;  // m
constexpr double kMostParts = 10'000.0;

}  // namespace

PlanTransform PlanTransform::operator*(const PlanTransform& o) const {
  return {a * o.a + c * o.b, b * o.a + d * o.b,     a * o.c + c * o.d,
          b * o.c + d * o.d, a * o.e + c * o.f + e, b * o.e + d * o.f + f};
}

PlanTransform PlanTransform::Turn(double radians) {
  const SinCosResult turn = SinCos(radians);
  return {turn.cos, turn.sin, -turn.sin, turn.cos, 0.0, 0.0};
}

bool PlanBuilder::AddLine(const std::string& layer, const PlanTransform& to_plan, const Vec2& start, const Vec2& end) {
  const PlanLine line{to_plan * start, to_plan * end};
  for (const double value : {line.start.x(), line.start.y(), line.end.x(), line.end.y()}) {
    if (!(std::fabs(value) <= kMaxMagnitude)) has_bad_number_ = true;
  }
  if (has_bad_number_ || ++count_ > kMaxPlanLines) return false;
  if ((line.end - line.start).norm() < kShortest) return true;
  const auto [place, is_new] = layers_.emplace(layer, plan_.layers.size());
  if (is_new) plan_.layers.push_back({layer, {}});
  plan_.layers[place->second].lines.push_back(line);
  return true;
}

bool PlanBuilder::AddArc(const std::string& layer, const PlanTransform& to_plan, const Vec2& center, const Vec2& radii,
                         double turn, double from, double sweep) {
  const PlanTransform to_page = to_plan * PlanTransform::Shift(center.x(), center.y()) * PlanTransform::Turn(turn);
  const double stretch = std::max(Vec2(to_plan.a, to_plan.b).norm(), Vec2(to_plan.c, to_plan.d).norm());
  const double radius = stretch * std::max(std::fabs(radii.x()), std::fabs(radii.y()));
  if (!(radius <= kMaxMagnitude)) {
    has_bad_number_ = true;
    return false;
  }
  // The sagitta of a chord over an angle w is r (1 - cos(w / 2)), about r w^2 / 8.
  const double step = std::sqrt(8.0 * kSagitta / std::max(radius, kSagitta));
  const double parts = std::clamp(std::ceil(std::fabs(sweep) / std::min(step, 0.25 * kPi)), 1.0, kMostParts);
  const auto point = [&](double part) {
    const SinCosResult at = SinCos(from + sweep * part / parts);
    return Vec2(radii.x() * at.cos, radii.y() * at.sin);
  };
  for (int part = 0; part < parts; ++part) {
    if (!AddLine(layer, to_page, point(part), point(part + 1))) return false;
  }
  return true;
}

bool PlanBuilder::AddCurve(const std::string& layer, const PlanTransform& to_plan, const Vec2& start, const Vec2& first,
                           const Vec2& second, const Vec2& end) {
  const Vec2 p[4] = {to_plan * start, to_plan * first, to_plan * second, to_plan * end};
  // The distance of n chords from a cubic is at most the largest second difference of its points, times 3 / (4 n^2).
  const double bend = std::max((p[0] - 2.0 * p[1] + p[2]).norm(), (p[1] - 2.0 * p[2] + p[3]).norm());
  if (!(bend <= 4.0 * kMaxMagnitude)) {
    has_bad_number_ = true;
    return false;
  }
  const double parts = std::clamp(std::ceil(std::sqrt(0.75 * bend / kSagitta)), 1.0, kMostParts);
  const auto point = [&](double part) -> Vec2 {
    const double t = part / parts;
    const double s = 1.0 - t;
    return s * s * s * p[0] + 3.0 * s * s * t * p[1] + 3.0 * s * t * t * p[2] + t * t * t * p[3];
  };
  for (int part = 0; part < parts; ++part) {
    if (!AddLine(layer, PlanTransform(), point(part), point(part + 1))) return false;
  }
  return true;
}

}  // namespace troupe
