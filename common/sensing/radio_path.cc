#include "common/sensing/radio_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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

RadioPaths::RadioPaths(const SensedWorld& world, RobotId robot, const AntennaPlace& from, double reach)
    : world_(world), from_(from), caster_(world.scene, world.bodies, from.at, reach, robot, Sight::kRangers) {}

RadioObstacles RadioPaths::To(RobotId robot, const AntennaPlace& to) {
  const Vec2 way = to.at - from_.at;
  const double length = std::sqrt(way.squaredNorm());
  if (!(length > kTouchTolerance)) return {};
  caster_.Cut(way / length, {std::min(from_.z, to.z), std::max(from_.z, to.z)}, cuts_);
  const double slope = (to.z - from_.z) / length;
  std::vector<Stretch> in_walls;
  std::vector<BodyId> bodies;
  for (const ColumnCut& cut : cuts_) {
    if (cut.enter >= length) break;
    const std::optional<Stretch> stretch = StretchIn(cut, from_.z, slope, length);
    if (!stretch) continue;
    const std::optional<BodyId> body = world_.scene.body_of(cut.model);
    if (!body) {
      in_walls.push_back(*stretch);
    } else if (world_.bodies.owner(*body) != robot) {
      bodies.push_back(*body);
    }
  }
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  return {CountWalls(in_walls), bodies.size()};
}

}  // namespace troupe
