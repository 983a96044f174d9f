#include "worldfile/sites/site_frame.h"

#include <cmath>

#include "common/geometry/limits.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

// One fiducial on two levels.
struct FiducialPair {
  Vec2 reference;
  Vec2 own;
};

}  // namespace

// m for a pixel: the mean over all measurements.
std::optional<double> ScaleOf(const LevelPlan& level) {
  if (level.measurements.empty()) return std::nullopt;
  double sum = 0.0;
  for (const SiteMeasurement& measurement : level.measurements) sum += measurement.meters / measurement.length;
  return sum / static_cast<double>(level.measurements.size());
}

// As rmf_building_map_tools: the mean of turns and stretches of all pairs of fiducials, then the mean shift.
std::optional<PlaneMap> AlignLevel(const LevelPlan& reference, double scale, const LevelPlan& level) {
  std::vector<FiducialPair> pairs;
  for (const SiteFiducial& a : reference.fiducials) {
    for (const SiteFiducial& b : level.fiducials) {
      if (a.name == b.name) pairs.push_back({a.position, b.position});
    }
  }
  Vec2 turn = Vec2::Zero();  // the sum of cosines and sines
  double stretch = 0.0;      // the sum
  int lines = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t k = i + 1; k < pairs.size(); ++k) {
      const Vec2 to = pairs[k].reference - pairs[i].reference;
      const Vec2 from = pairs[k].own - pairs[i].own;
      const double product = to.norm() * from.norm();
      if (!(product > 0.0)) continue;
      // A sum of unit vectors: the mean of angles that may lie on both sides of 180 degrees.
      turn += Vec2(from.dot(to), from.x() * to.y() - from.y() * to.x()) / product;
      stretch += from.norm() / to.norm();
      ++lines;
    }
  }
  if (lines == 0 || !(turn.norm() > 0.0)) return std::nullopt;
  PlaneMap map;
  map.cos = turn.x() / turn.norm();
  map.sin = turn.y() / turn.norm();
  map.scale = scale * lines / stretch;
  Vec2 shift = Vec2::Zero();
  for (const FiducialPair& pair : pairs) shift += scale * pair.reference - map * pair.own;
  map.shift = shift / static_cast<double>(pairs.size());
  return map;
}

// To W: metres, y up. The offset moves the world near the origin, where coordinates are precise.
Vec2 SiteFrame::operator*(const Vec2& p) const {
  switch (coordinates_) {
    case SiteCoordinates::kReferenceImage:
      return {p.x(), -p.y()};
    case SiteCoordinates::kCartesianMeters:
      return p - offset_;
    case SiteCoordinates::kWebMercator: {
      const Vec2 degrees = FromWebMercator(p);
      return projection_.Project(degrees.x(), degrees.y()) - offset_;
    }
    case SiteCoordinates::kWgs84:
      return projection_.Project(p.x(), p.y()) - offset_;
  }
  return p;
}

// To a micrometre: the results of projections differ in their last bits from machine to machine. The zero that is added
// turns -0 into 0.
Vec2 Rounded(const Vec2& p) {
  const auto round = [](double value) { return std::round(value * 1e6) / 1e6 + 0.0; };
  return {round(p.x()), round(p.y())};
}

}  // namespace troupe
