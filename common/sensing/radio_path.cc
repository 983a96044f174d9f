#include "common/sensing/radio_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/spatial/ray_cast.h"

namespace troupe {
namespace {

// The part of a line that climbs by `slope` m for each m, from height `z`, within a cut.
std::optional<LinePart> PartIn(const ColumnCut& cut, double z, double slope, double length) {
  LinePart part{cut.enter, std::min(cut.leave, length)};
  if (slope == 0.0) {
    if (!cut.z.Contains(z)) return std::nullopt;
  } else {
    const double at_min = (cut.z.min - z) / slope;
    const double at_max = (cut.z.max - z) / slope;
    part.enter = std::max(part.enter, std::min(at_min, at_max));
    part.leave = std::min(part.leave, std::max(at_min, at_max));
  }
  if (!(part.leave - part.enter > kTouchTolerance)) return std::nullopt;
  return part;
}

std::size_t CountWalls(std::vector<LinePart>& parts) {
  std::sort(parts.begin(), parts.end(), [](const LinePart& a, const LinePart& b) { return a.enter < b.enter; });
  std::size_t walls = 0;
  double end = -std::numeric_limits<double>::infinity();
  for (const LinePart& part : parts) {
    if (part.enter - end >= kWallGap) ++walls;
    end = std::max(end, part.leave);
  }
  return walls;
}

}  // namespace

// Horizontal rays are cast all together. Nearly all lines are clear, or of no use beyond their first obstacle.
RadioPaths::RadioPaths(const SensedWorld& world, const Antenna& to, std::span<const RadioSignal> signals)
    : world_(world), to_(to), signals_(signals), first_(signals.size()), is_clear_(signals.size(), false) {
  std::vector<Ray> rays;
  std::vector<std::size_t> signal_of_ray;
  rays.reserve(signals.size());
  signal_of_ray.reserve(signals.size());
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
  obstacles_.clear();
  double end = length;
  for (const ColumnCut& cut : cuts_) {
    if (cut.enter >= length) break;
    const std::optional<LinePart> part = PartIn(cut, to_.z, slope, length);
    if (!part) continue;
    const std::optional<BodyId> body = world_.scene.body_of(cut.model);
    if (body && world_.bodies.owner(*body) == from.robot) {
      end = std::min(end, part->enter);
    } else {
      obstacles_.push_back({*part, body});
    }
  }
  walls_.clear();
  bodies_.clear();
  for (const ObstacleOnLine& obstacle : obstacles_) {
    if (!(std::min(obstacle.part.leave, end) - obstacle.part.enter > kTouchTolerance)) continue;
    if (obstacle.body) {
      bodies_.push_back(*obstacle.body);
    } else {
      walls_.push_back(obstacle.part);
    }
  }
  std::sort(bodies_.begin(), bodies_.end());
  bodies_.erase(std::unique(bodies_.begin(), bodies_.end()), bodies_.end());
  return {CountWalls(walls_), bodies_.size()};
}

}  // namespace troupe
