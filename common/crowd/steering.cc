#include "common/crowd/steering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace troupe {
namespace {

constexpr double kHorizon = 4.0;       // m that a walker looks ahead
constexpr double kReaction = 0.25;     // s, between a walker and the one before it
constexpr double kWallReaction = 0.2;  // s, between a walker and a wall
constexpr double kCreep = 0.1;         // m/s: without a gap a walker still presses on; ORCA and the mover stop it
constexpr double kBlocked = 2.0;       // the cost of a direction without any way; 1: of a turn by 90 degrees
constexpr double kQueue = 0.6;         // of the horizon, that others with the same way leave free
constexpr double kStanding = 1e-6;     // m/s
constexpr double kGrazing = 1e-9;      // of the cosine between a direction and the normal of a wall
constexpr double kFar = std::numeric_limits<double>::infinity();

struct Turn {
  double cos;
  double sin;
};
// Every ten degrees.
constexpr std::array kTurns{Turn{1.0, 0.0},
                            Turn{0.98480775301220806, 0.17364817766693035},
                            Turn{0.93969262078590838, 0.34202014332566873},
                            Turn{0.86602540378443865, 0.5},
                            Turn{0.76604444311897804, 0.64278760968653933},
                            Turn{0.64278760968653933, 0.76604444311897804},
                            Turn{0.5, 0.86602540378443865},
                            Turn{0.34202014332566873, 0.93969262078590838},
                            Turn{0.17364817766693035, 0.98480775301220806},
                            Turn{0.0, 1.0}};

// The time until a point with the velocity `v` touches the disc at `to`, of which it is `gap` (m^2) outside; none:
// kFar.
double TimeToDisc(const Vec2& to, double gap, const Vec2& v) {
  const double nearing = to.dot(v);
  if (nearing <= 0.0) return kFar;
  if (gap <= 0.0) return 0.0;
  const double square = v.squaredNorm();
  const double discriminant = nearing * nearing - square * gap;
  return discriminant < 0.0 ? kFar : (nearing - std::sqrt(discriminant)) / square;
}

}  // namespace

void Steering::See(const Walker& walker, const Vec2& way, std::span<const WalkerNeighbor> neighbors,
                   std::span<const WallSegment> walls) {
  others_.clear();
  for (const WalkerNeighbor& neighbor : neighbors) {
    Other& other = others_.emplace_back();
    other.to = neighbor.position - walker.position;
    other.velocity = neighbor.velocity;
    other.square = (walker.radius + neighbor.radius) * (walker.radius + neighbor.radius);
    other.gap = other.to.squaredNorm() - other.square;
    other.least_free = kQueue * kHorizon * std::max(0.0, neighbor.heading.dot(way));
  }
  walls_.clear();
  for (const WallSegment& segment : walls) {
    Wall& wall = walls_.emplace_back();
    wall.a = segment.a - walker.position;
    wall.b = segment.b - walker.position;
    const Vec2 along = segment.b - segment.a;
    const double length = along.norm();
    wall.along = along / (length * length);
    wall.normal = Vec2(along.y(), -along.x()) / length;
    wall.distance = -wall.a.dot(wall.normal);
    if (wall.distance >= 0.0) continue;
    wall.normal = -wall.normal;
    wall.distance = -wall.distance;
  }
}

// m, until the walker touches a wall.
double Steering::WallAt(const Vec2& direction, double radius) const {
  double least = kFar;
  for (const Wall& wall : walls_) {
    const double closing = -direction.dot(wall.normal);
    if (closing > kGrazing) {
      const double way = std::max(0.0, (wall.distance - radius) / closing);
      const double s = (way * direction - radius * wall.normal - wall.a).dot(wall.along);
      if (s >= 0.0 && s <= 1.0) least = std::min(least, way);
    }
    for (const Vec2& end : {wall.a, wall.b}) {
      least = std::min(least, TimeToDisc(end, end.squaredNorm() - radius * radius, direction));
    }
  }
  return least;
}

// m, at most kHorizon, until the walker meets another or a wall at full speed.
double Steering::FreeAt(const Vec2& direction, double speed, double radius) const {
  double free = std::min(kHorizon, WallAt(direction, radius));
  for (const Other& other : others_) {
    if (other.least_free >= free) continue;
    const double time = TimeToDisc(other.to, other.gap, speed * direction - other.velocity);
    free = std::min(free, std::max(other.least_free, speed * time));
  }
  return free;
}

// m, to the place where the nearest other is now.
double Steering::GapAt(const Vec2& direction) const {
  double least = kFar;
  for (const Other& other : others_) least = std::min(least, TimeToDisc(other.to, other.gap, direction));
  return least;
}

Vec2 Steering::Prefer(const Walker& walker, std::span<const WalkerNeighbor> neighbors,
                      std::span<const WallSegment> walls) {
  const double speed = walker.preferred.norm();
  if (speed < kStanding) return walker.preferred;
  const Vec2 way = walker.preferred / speed;
  See(walker, way, neighbors, walls);
  Vec2 best = way;
  double least = kFar;
  for (std::size_t i = 0; i < kTurns.size() && 1.0 - kTurns[i].cos < least; ++i) {
    for (const double side : {-1.0, 1.0}) {  // the right one first
      const double cos = kTurns[i].cos;
      const double sin = side * kTurns[i].sin;
      const Vec2 direction(cos * way.x() - sin * way.y(), sin * way.x() + cos * way.y());
      const double blocked = 1.0 - FreeAt(direction, speed, walker.radius) / kHorizon;
      const double cost = 1.0 - cos + kBlocked * blocked * blocked;
      if (cost < least) {
        least = cost;
        best = direction;
      }
      if (i == 0) break;
    }
  }
  const double most = std::min(std::max(kCreep, GapAt(best) / kReaction),
                               std::max(kCreep, WallAt(best, walker.radius) / kWallReaction));
  return std::min(speed, most) * best;
}

}  // namespace troupe
