#include "common/crowd/orca.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace troupe {
namespace {

constexpr double kParallel = 1e-9;  // lines whose directions' cross product is less are parallel
constexpr double kCovered = 1e-9;   // m/s

double Square(double value) {
  return value * value;
}
Vec2 LeftOf(const Vec2& v) {
  return {-v.y(), v.x()};
}
Vec2 RightOf(const Vec2& v) {
  return {v.y(), -v.x()};
}
// A unit vector for the null vector, too.
Vec2 Unit(const Vec2& v) {
  const double length = v.norm();
  return length > 0.0 ? Vec2(v / length) : Vec2(1.0, 0.0);
}

// How far a velocity is outside, m/s; negative inside.
// Directions have length 1, so that a cross product is a distance.
double Excess(const VelocityHalfPlane& plane, const Vec2& velocity) {
  return Cross(plane.direction, plane.point - velocity);
}

// What the linear programs look for: the velocity nearest to `optimum`, or the farthest in its direction.
struct Objective {
  Vec2 optimum;
  bool is_direction = false;
};

// The best velocity on the line of number `index`, inside the planes before it and the disc of `speed`. False, and
// `velocity` unchanged, if there is none.
bool BestOnLine(std::span<const VelocityHalfPlane> planes, std::size_t index, double speed, const Objective& objective,
                Vec2& velocity) {
  const VelocityHalfPlane& line = planes[index];
  const double middle = line.point.dot(line.direction);
  // The line within the disc of the possible speeds: none if it passes outside.
  const double discriminant = Square(middle) + Square(speed) - line.point.squaredNorm();
  if (discriminant < 0.0) return false;
  double least = -middle - std::sqrt(discriminant);
  double most = -middle + std::sqrt(discriminant);
  for (const VelocityHalfPlane& other : planes.first(index)) {
    const double denominator = Cross(line.direction, other.direction);
    const double numerator = Cross(other.direction, line.point - other.point);
    if (std::fabs(denominator) <= kParallel) {
      if (numerator < 0.0) return false;
      continue;
    }
    const double t = numerator / denominator;
    (denominator >= 0.0 ? most : least) = denominator >= 0.0 ? std::min(most, t) : std::max(least, t);
    if (least > most) return false;
  }
  double t = 0.0;
  if (objective.is_direction) {
    t = objective.optimum.dot(line.direction) > 0.0 ? most : least;
  } else {
    t = std::clamp(line.direction.dot(objective.optimum - line.point), least, most);
  }
  velocity = line.point + t * line.direction;
  return true;
}

// The best velocity inside all planes; the number of the first plane that has no velocity in common with its
// predecessors, or of all.
std::size_t BestInside(std::span<const VelocityHalfPlane> planes, double speed, const Objective& objective,
                       Vec2& velocity) {
  if (objective.is_direction) {
    velocity = speed * objective.optimum;
  } else {
    const bool is_within = objective.optimum.squaredNorm() <= Square(speed);
    velocity = is_within ? objective.optimum : Vec2(speed * Unit(objective.optimum));
  }
  for (std::size_t i = 0; i < planes.size(); ++i) {
    // While the velocity is inside a plane, the plane changes nothing. Else the best one is on its border.
    if (Excess(planes[i], velocity) > 0.0 && !BestOnLine(planes, i, speed, objective, velocity)) return i;
  }
  return planes.size();
}

// Inside the first `hard` planes, and out of the others from `begin` on by as little as possible.
void LeastOutside(std::span<const VelocityHalfPlane> planes, std::size_t hard, std::size_t begin, double speed,
                  std::vector<VelocityHalfPlane>& projected, Vec2& velocity) {
  double distance = 0.0;
  for (std::size_t i = begin; i < planes.size(); ++i) {
    const VelocityHalfPlane& plane = planes[i];
    if (Excess(plane, velocity) <= distance) continue;
    projected.assign(planes.begin(), planes.begin() + static_cast<std::ptrdiff_t>(hard));
    for (std::size_t k = hard; k < i; ++k) {
      const VelocityHalfPlane& other = planes[k];
      const double det = Cross(plane.direction, other.direction);
      VelocityHalfPlane between;
      if (std::fabs(det) <= kParallel) {
        // Parallel and to the same side: the farther one decides alone.
        if (plane.direction.dot(other.direction) > 0.0) continue;
        between.point = 0.5 * (plane.point + other.point);
      } else {
        between.point = plane.point + Cross(other.direction, plane.point - other.point) / det * plane.direction;
      }
      between.direction = Unit(other.direction - plane.direction);
      projected.push_back(between);
    }
    // By rounding the program may find nothing where there is a point: the velocity so far stays.
    const Vec2 before = velocity;
    if (BestInside(projected, speed, {LeftOf(plane.direction), true}, velocity) < projected.size()) velocity = before;
    distance = Excess(plane, velocity);
  }
}

// The directions of the tangents from the origin to the disc at `center`. REQUIRES: the origin is outside.
Vec2 LeftTangent(const Vec2& center, double radius) {
  const double square = center.squaredNorm();
  const double leg = std::sqrt(square - Square(radius));
  return Vec2(center.x() * leg - center.y() * radius, center.x() * radius + center.y() * leg) / square;
}
Vec2 RightTangent(const Vec2& center, double radius) {
  const double square = center.squaredNorm();
  const double leg = std::sqrt(square - Square(radius));
  return Vec2(center.x() * leg + center.y() * radius, -center.x() * radius + center.y() * leg) / square;
}

}  // namespace

void Orca::AddNeighbor(const Walker& walker, const WalkerNeighbor& neighbor) {
  const Vec2 to = neighbor.position - walker.position;
  const Vec2 relative = walker.velocity - neighbor.velocity;
  const double radius = walker.radius + neighbor.radius;
  VelocityHalfPlane plane;
  Vec2 change;  // of the relative velocity, to the border of the colliding velocities
  // Discs that overlap already are to be apart after one tick, not after the horizon.
  const bool overlaps = to.squaredNorm() <= Square(radius);
  const double horizon = overlaps ? horizons_.tick : horizons_.walkers;
  const Vec2 from_center = relative - to / horizon;  // of the disc at the end of the cone
  const double along = from_center.dot(to);
  // The relative velocity is nearest to the disc at the end of the cone, else to one of its sides.
  if (overlaps || (along < 0.0 && Square(along) > Square(radius) * from_center.squaredNorm())) {
    const Vec2 outwards = Unit(from_center);
    plane.direction = RightOf(outwards);
    change = (radius / horizon - from_center.norm()) * outwards;
  } else {
    const bool is_left = Cross(to, from_center) > 0.0;
    plane.direction = is_left ? LeftTangent(to, radius) : Vec2(-RightTangent(to, radius));
    change = relative.dot(plane.direction) * plane.direction - relative;
  }
  plane.point = walker.velocity + neighbor.share * change;
  planes_.push_back(plane);
}

void Orca::AddWall(const Walker& walker, const WallSegment& wall) {
  const double radius = walker.radius;
  const double rate = 1.0 / horizons_.walls;
  Vec2 a = wall.a - walker.position;
  Vec2 b = wall.b - walker.position;
  if (Cross(b - a, -a) > 0.0) std::swap(a, b);  // the walker is on the right
  const auto covers = [&](const VelocityHalfPlane& plane) {
    return Excess(plane, rate * a) >= rate * radius - kCovered && Excess(plane, rate * b) >= rate * radius - kCovered;
  };
  // Another wall, nearer, forbids all that this one would: the sides of a piece behind its front.
  if (std::any_of(planes_.begin(), planes_.end(), covers)) return;
  const Vec2 along = b - a;
  const double s = -a.dot(along) / along.squaredNorm();  // of the foot of the perpendicular
  const double square_to_line = (a + s * along).squaredNorm();
  const bool near_line = square_to_line <= Square(radius);
  // In contact: no velocity towards the wall.
  if (s < 0.0 && a.squaredNorm() <= Square(radius)) return planes_.push_back({Vec2::Zero(), LeftOf(Unit(a))});
  if (s > 1.0 && b.squaredNorm() <= Square(radius)) return planes_.push_back({Vec2::Zero(), LeftOf(Unit(b))});
  if (s >= 0.0 && s <= 1.0 && near_line) return planes_.push_back({Vec2::Zero(), Unit(-along)});

  // A wall seen from its end is that end.
  if (near_line && s < 0.0) b = a;
  if (near_line && s > 1.0) a = b;
  const bool is_point = near_line;
  const Vec2 left = LeftTangent(a, radius);
  const Vec2 right = RightTangent(b, radius);
  const Vec2 left_end = rate * a;
  const Vec2 right_end = rate * b;
  const Vec2& v = walker.velocity;
  const Vec2 across = right_end - left_end;
  const double t = is_point ? 0.5 : (v - left_end).dot(across) / across.squaredNorm();
  const double t_left = (v - left_end).dot(left);
  const double t_right = (v - right_end).dot(right);
  const auto beside = [&](const Vec2& end) {
    const Vec2 outwards = Unit(v - end);
    planes_.push_back({end + radius * rate * outwards, RightOf(outwards)});
  };
  if ((t < 0.0 && t_left < 0.0) || (is_point && t_left < 0.0 && t_right < 0.0)) return beside(left_end);
  if (t > 1.0 && t_right < 0.0) return beside(right_end);
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const bool faces = !is_point && t >= 0.0 && t <= 1.0;
  const double to_front = faces ? (v - (left_end + t * across)).squaredNorm() : kFar;
  const double to_left = t_left < 0.0 ? kFar : (v - (left_end + t_left * left)).squaredNorm();
  const double to_right = t_right < 0.0 ? kFar : (v - (right_end + t_right * right)).squaredNorm();
  const auto border = [&](const Vec2& end, const Vec2& direction) {
    planes_.push_back({end + radius * rate * LeftOf(direction), direction});
  };
  if (to_front <= to_left && to_front <= to_right) return border(left_end, Unit(-along));
  if (to_left <= to_right) return border(left_end, left);
  border(right_end, -right);
}

Vec2 Orca::Velocity(const Walker& walker, std::span<const WalkerNeighbor> neighbors,
                    std::span<const WallSegment> walls) {
  planes_.clear();
  for (const WallSegment& wall : walls) AddWall(walker, wall);
  const std::size_t hard = planes_.size();
  for (const WalkerNeighbor& neighbor : neighbors) AddNeighbor(walker, neighbor);
  Vec2 velocity;
  const std::size_t failed = BestInside(planes_, walker.max_speed, {walker.preferred, false}, velocity);
  if (failed < planes_.size()) LeastOutside(planes_, hard, failed, walker.max_speed, projected_, velocity);
  return velocity;
}

}  // namespace troupe
