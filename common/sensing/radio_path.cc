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
RadioPaths::RadioPaths(const SensedWorld& world, const Antenna& to, std::span<const RadioSignal> signals)
    : world_(world), to_(to), signals_(signals), first_(signals.size()), is_clear_(signals.size(), false) {
  std::vector<Ray> rays;
  std::vector<std::size_t> signal_of_ray;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const Antenna& from = signals[i].from;
    const Vec2 way = from.at - to.at;
    const double length = std::sqrt(way.squaredNorm());
    const bool ignores_obstacles = signals[i].sender->wall_loss == 0.0 && signals[i].sender->body_loss == 0.0;
    if (!(length > kTouchTolerance) || ignores_obstacles) {
      is_clear_[i] = true;
    } else if (from.z == to.z) {
      rays.push_back({to.at, way / length, to.z, length});
      signal_of_ray.push_back(i);
    }
  }
  std::vector<std::optional<RayHit>> hits;
  CastRays(world.scene, world.bodies, rays, to.robot, hits);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const std::size_t i = signal_of_ray[k];
    const std::optional<BodyId> body = hits[k] ? world.scene.body_of(hits[k]->model) : std::nullopt;
    if (!hits[k] || (body && world.bodies.owner(*body) == signals[i].from.robot)) {
      is_clear_[i] = true;
    } else if (!body) {
      first_[i].walls = 1;
    } else {
      first_[i].bodies = 1;
    }
  }
}

std::optional<double> RadioPaths::StrengthOf(std::size_t i) {
  const RadioSignal& signal = signals_[i];
  if (is_clear_[i]) return signal.clear;
  if (!signal.Passes(first_[i])) return std::nullopt;
  const RadioObstacles obstacles = CountObstacles(signal.from);
  if (!signal.Passes(obstacles)) return std::nullopt;
  return signal.clear - signal.LossBy(obstacles);
}

RadioObstacles RadioPaths::CountObstacles(const Antenna& from) {
  const Vec2 way = from.at - to_.at;
  const double length = std::sqrt(way.squaredNorm());
  if (!caster_) {
    double reach = 0.0;
    for (std::size_t i = 0; i < signals_.size(); ++i) {
      if (is_clear_[i] || !signals_[i].Passes(first_[i])) continue;
      reach = std::max(reach, std::sqrt((signals_[i].from.at - to_.at).squaredNorm()));
    }
    caster_.emplace(world_.scene, world_.bodies, to_.at, reach, to_.robot, Sight::kRangers);
  }
  caster_->Cut(way / length, {std::min(to_.z, from.z), std::max(to_.z, from.z)}, length, cuts_);
  const double slope = (from.z - to_.z) / length;
  struct InBody {
    Stretch stretch;
    std::optional<BodyId> body;  // nothing: static
  };
  std::vector<InBody> parts;
  double end = length;
  for (const ColumnCut& cut : cuts_) {
    if (cut.enter >= length) break;
    const std::optional<Stretch> stretch = StretchIn(cut, to_.z, slope, length);
    if (!stretch) continue;
    const std::optional<BodyId> body = world_.scene.body_of(cut.model);
    if (body && world_.bodies.owner(*body) == from.robot) {
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
