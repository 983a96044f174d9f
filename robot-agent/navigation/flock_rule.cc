#include "robot-agent/navigation/flock_rule.h"

#include <algorithm>
#include <cmath>

#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kSeparation = 2.0;  // weights, of the direction ahead 1
constexpr double kCohesion = 1.0;
constexpr double kAlignment = 1.0;

}  // namespace

Vec2 FlockDirection(const std::vector<Neighbour>& neighbours, double distance) {
  Vec2 wanted(1.0, 0.0);
  if (neighbours.empty()) return wanted;
  Vec2 separation = Vec2::Zero();
  Vec2 center = Vec2::Zero();
  Vec2 course = Vec2::Zero();
  for (const Neighbour& neighbour : neighbours) {
    const double apart = std::max(std::sqrt(neighbour.p_R.squaredNorm()), 1e-3);
    separation -= std::max(1.0 - apart / distance, 0.0) * neighbour.p_R / apart;
    center += neighbour.p_R;
    const SinCosResult heading = SinCos(neighbour.heading);
    course += Vec2(heading.cos, heading.sin);
  }
  const double count = static_cast<double>(neighbours.size());
  const Vec2 mean = center / count;
  const double apart = std::sqrt(mean.squaredNorm());
  // A middle at its distance neither attracts nor repels.
  const double pull = std::min(std::max(apart - distance, 0.0) / distance, 1.0);
  wanted += kSeparation * separation + kAlignment * course / count;
  if (apart > 1e-3) wanted += kCohesion * pull * mean / apart;
  return wanted.squaredNorm() < 1e-12 ? Vec2::Zero() : wanted;
}

double FlockSpeed(const Vec2& direction) {
  return std::clamp(0.5 + 0.25 * direction.x(), 0.2, 1.0);
}

}  // namespace troupe
