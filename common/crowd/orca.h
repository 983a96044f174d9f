// Optimal reciprocal collision avoidance (ORCA; van den Berg, Guy, Lin, Manocha, 2011): the velocity with which a
// walker comes nearest to the one that it prefers, such that it meets no other walker and no wall within a horizon of
// time.
//
// A pure function of + - * / and sqrt, so that all machines compute the same bits. The order of neighbours and walls
// can decide between velocities that are equally good: callers pass them by distance, then by id.
//
// Each neighbour within the horizon forbids the velocities on one side of a line in the plane of velocities, and so
// does each wall; the result is the point nearest to the preferred velocity in what is left, found by the incremental
// linear program of the paper. Where nothing is left, the constraints of walls stay, and the constraints of neighbours
// are moved back together by the least distance that leaves a velocity (a linear program in three dimensions, as in the
// paper).
//
// Cost: the square of the numbers of neighbours and walls in the worst case, so that callers pass the nearest ones
// only. One Orca is for one thread: it keeps its lists.
#pragma once

#include <span>
#include <vector>

#include "troupe/vec2.h"

namespace troupe {

struct Walker {
  Vec2 position{0.0, 0.0};   // m
  Vec2 velocity{0.0, 0.0};   // m/s
  Vec2 preferred{0.0, 0.0};  // m/s, the velocity without any other
  double radius = 0.0;       // m
  double max_speed = 0.0;    // m/s
};

struct WalkerNeighbor {
  Vec2 position{0.0, 0.0};
  Vec2 velocity{0.0, 0.0};
  double radius = 0.0;
  double share =
      0.5;  // of the avoidance that the walker makes: 0.5 beside another walker, 1 beside a body that does not avoid
  Vec2 heading{0.0, 0.0};  // of length 1: where it goes or would like to go; zero for a body without a way of its own
};

struct WallSegment {
  Vec2 a{0.0, 0.0};  // m; different from b
  Vec2 b{0.0, 0.0};
};

struct OrcaHorizons {
  double walkers = 1.0;  // s, all above 0
  double walls = 1.0;
  double tick = 0.1;  // within which walkers that overlap move apart
};

// The velocities on the left of a line, m/s.
struct VelocityHalfPlane {
  Vec2 point{0.0, 0.0};
  Vec2 direction{1.0, 0.0};  // of length 1
};

class Orca {
 public:
  explicit Orca(const OrcaHorizons& horizons) : horizons_(horizons) {}

  // If no velocity avoids all, it avoids the walls, and the others as far as it can.
  Vec2 Velocity(const Walker& walker, std::span<const WalkerNeighbor> neighbors, std::span<const WallSegment> walls);

 private:
  void AddWall(const Walker& walker, const WallSegment& wall);
  void AddNeighbor(const Walker& walker, const WalkerNeighbor& neighbor);

  const OrcaHorizons horizons_;
  std::vector<VelocityHalfPlane> planes_;     // of walls, then of neighbours
  std::vector<VelocityHalfPlane> projected_;  // memory of Velocity
};

}  // namespace troupe
