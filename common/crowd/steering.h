// Steering: the direction and speed that a walker prefers among others, before the avoidance of collisions (orca.h).
// ORCA alone keeps walkers apart, but not as people do it: they hardly slow down in a crowd, meet in doorways without
// giving way, and stand before an oncoming crowd.
//
// The rules are those of Moussaid, Helbing and Theraulaz ("How simple rules determine pedestrian behavior and crowd
// disasters", PNAS 2011). A walker looks at directions up to 90 degrees from that of its way, and supposes that others
// keep their velocities. It prefers the direction in which it comes far without a collision, and which leads it far on
// its way. In this direction it walks so slowly that it would need kReaction for the gap before it. From this follow
// lanes of people with one way, and speeds by density near those that are measured (docs/people.md).
//
// Two rules are added. A walker that is blocked by others with its own way counts as half free: people queue, and do
// not walk to and fro behind those before them. And blocked ways cost more than in the paper, so that a walker goes
// aside where it would else stand before one that comes towards it.
//
// A function of + - * / and sqrt, so that all machines compute the same bits. Of two directions that are equally good
// the one nearer to the way is chosen, then the right one. Cost: linear in neighbours and walls, times the directions
// looked at; a walker with a free way looks at one. One Steering is for one thread: it keeps its lists.
#pragma once

#include <span>
#include <vector>

#include "common/crowd/orca.h"
#include "troupe/vec2.h"

namespace troupe {

class Steering {
 public:
  // The velocity (m/s) that the walker prefers: in place of walker.preferred, and not faster.
  Vec2 Prefer(const Walker& walker, std::span<const WalkerNeighbor> neighbors, std::span<const WallSegment> walls);

 private:
  // A disc, as the walker sees it.
  struct Other {
    Vec2 to{0.0, 0.0};        // m, from the walker
    Vec2 velocity{0.0, 0.0};  // m/s
    double square = 0.0;      // m^2, of the sum of the radii
    double gap = 0.0;         // m^2: the square of the distance less that
    double least_free = 0.0;  // m: it blocks no direction before
  };
  struct Wall {
    Vec2 a{0.0, 0.0};      // m, from the walker
    Vec2 along{0.0, 0.0};  // to the other end, divided by the square of the length
    Vec2 b{0.0, 0.0};
    Vec2 normal{0.0, 0.0};  // of length 1, towards the walker
    double distance = 0.0;  // m, of the walker to the line
  };

  void See(const Walker& walker, const Vec2& way, std::span<const WalkerNeighbor> neighbors,
           std::span<const WallSegment> walls);
  double FreeAt(const Vec2& direction, double speed, double radius) const;
  double GapAt(const Vec2& direction) const;
  double WallAt(const Vec2& direction, double radius) const;

  std::vector<Other> others_;
  std::vector<Wall> walls_;
};

}  // namespace troupe
