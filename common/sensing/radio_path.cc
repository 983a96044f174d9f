#include "common/sensing/radio_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/spatial/ray_cast.h"

namespace troupe {
namespace {

// The part of a line that climbs by `slope` m for each m, from height `z`, within a cut: m along the line's foot.
struct Stretch {
  double enter;
  double leave;
};

std::optional<Stretch> StretchIn(const ColumnCut& cut, double z, double slope, double length) {
  Stretch stretch{cut.enter, std::min(cut.leave, length)};
  if (slope == 0.0) {
    if (!cut.z.Contains(z)) return std::nullopt;
  } else {
    const double at_min = (cut.z.min - z) / slope;
    const double at_max = (cut.z.max - z) / slope;
    stretch.enter = std::max(stretch.enter, std::min(at_min, at_max));
    stretch.leave = std::min(stretch.leave, std::max(at_min, at_max));
  }
  if (!(stretch.leave - stretch.enter > kTouchTolerance)) return std::nullopt;
  return stretch;
}

std::size_t CountWalls(std::vector<Stretch>& stretches) {
  std::sort(stretches.begin(), stretches.end(), [](const Stretch& a, const Stretch& b) { return a.enter < b.enter; });
  std::size_t walls = 0;
  double end = -std::numeric_limits<double>::infinity();
  for (const Stretch& stretch : stretches) {
    if (stretch.enter - end >= kWallGap) ++walls;
    end = std::max(end, stretch.leave);
  }
  return walls;
}

}  // namespace

// Horizontal rays are cast all together. Nearly all lines are clear, or of no use beyond their first obstacle.
RadioPaths::RadioPaths(const SensedWorld& world, const Antenna& from, std::span<const Antenna> ends)
    : world_(world), from_(from), ends_(ends), first_(ends.size()), is_clear_(ends.size(), false) {
  std::vector<Ray> rays;
  std::vector<std::size_t> end_of_ray;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const Vec2 way = ends[i].at - from.at;
    const double length = std::sqrt(way.squaredNorm());
    if (!(length > kTouchTolerance)) {
      is_clear_[i] = true;
    } else if (ends[i].z == from.z) {
      rays.push_back({from.at, way / length, from.z, length});
      end_of_ray.push_back(i);
    }
  }
  std::vector<std::optional<RayHit>> hits;
  CastRays(world.scene, world.bodies, rays, from.robot, hits);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const std::size_t i = end_of_ray[k];
    const std::optional<BodyId> body = hits[k] ? world.scene.body_of(hits[k]->model) : std::nullopt;
    if (!hits[k] || (body && world.bodies.owner(*body) == ends[i].robot)) {
      is_clear_[i] = true;
    } else if (!body) {
      first_[i].walls = 1;
    } else {
      first_[i].bodies = 1;
    }
  }
}

RadioObstacles RadioPaths::All(std::size_t i) {
  if (is_clear_[i]) return {};
  const Antenna& to = ends_[i];
  const Vec2 way = to.at - from_.at;
  const double length = std::sqrt(way.squaredNorm());
  if (!caster_) {
    double reach = 0.0;
    for (const Antenna& end : ends_) reach = std::max(reach, std::sqrt((end.at - from_.at).squaredNorm()));
    caster_.emplace(world_.scene, world_.bodies, from_.at, reach, from_.robot, Sight::kRangers);
  }
  caster_->Cut(way / length, {std::min(from_.z, to.z), std::max(from_.z, to.z)}, cuts_);
  const double slope = (to.z - from_.z) / length;
  struct InBody {
    Stretch stretch;
    std::optional<BodyId> body;  // nothing: static
  };
  std::vector<InBody> parts;
  double end = length;
  for (const ColumnCut& cut : cuts_) {
    if (cut.enter >= length) break;
    const std::optional<Stretch> stretch = StretchIn(cut, from_.z, slope, length);
    if (!stretch) continue;
    const std::optional<BodyId> body = world_.scene.body_of(cut.model);
    if (body && world_.bodies.owner(*body) == to.robot) {
      end = std::min(end, stretch->enter);
    } else {
      parts.push_back({*stretch, body});
    }
  }
  std::vector<Stretch> walls;
  std::vector<BodyId> bodies;
  for (const InBody& part : parts) {
    if (!(std::min(part.stretch.leave, end) - part.stretch.enter > kTouchTolerance)) continue;
    if (part.body) {
      bodies.push_back(*part.body);
    } else {
      walls.push_back(part.stretch);
    }
  }
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  return {CountWalls(walls), bodies.size()};
}

}  // namespace troupe
