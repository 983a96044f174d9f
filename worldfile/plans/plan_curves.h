// PlanBuilder: collects the lines of a drawing; curves become chords that are nowhere farther from them than kSagitta.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "worldfile/plans/floor_plan.h"

namespace troupe {

// x' = a x + c y + e, y' = b x + d y + f: the six numbers of SVG's matrix.
struct PlanTransform {
  double a = 1.0, b = 0.0, c = 0.0, d = 1.0, e = 0.0, f = 0.0;
  Vec2 operator*(const Vec2& p) const { return {a * p.x() + c * p.y() + e, b * p.x() + d * p.y() + f}; }
  // First `other`, then this.
  PlanTransform operator*(const PlanTransform& other) const;
  static PlanTransform Shift(double x, double y) { return {1.0, 0.0, 0.0, 1.0, x, y}; }
  static PlanTransform Scale(double x, double y) { return {x, 0.0, 0.0, y, 0.0, 0.0}; }
  static PlanTransform Turn(double radians);
};

class PlanBuilder {
 public:
  static constexpr double kSagitta = 0.005;  // m

  // Points are in units of the file, transformed to metres by `to_plan` of each call. False: there are too many lines.
  bool AddLine(const std::string& layer, const PlanTransform& to_plan, const Vec2& start, const Vec2& end);
  // An arc of an ellipse whose half axes are along x and y before it is turned by `turn` (rad), from the angle `from`
  // through `sweep` (rad, positive to the left), by its parameter.
  bool AddArc(const std::string& layer, const PlanTransform& to_plan, const Vec2& center, const Vec2& radii,
              double turn, double from, double sweep);
  // A cubic of Bezier.
  bool AddCurve(const std::string& layer, const PlanTransform& to_plan, const Vec2& start, const Vec2& first,
                const Vec2& second, const Vec2& end);

  bool has_bad_number() const { return has_bad_number_; }
  FloorPlan Take() { return std::move(plan_); }
  std::vector<Warning>& warnings() { return plan_.warnings; }

 private:
  FloorPlan plan_;
  std::map<std::string, std::size_t> layers_;
  std::size_t count_ = 0;        // of lines, with those that are too short
  bool has_bad_number_ = false;  // a point is not finite, or beyond all limits
};

}  // namespace troupe
