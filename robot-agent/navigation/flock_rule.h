// The rule of a flock: each robot moves with its neighbours.
#pragma once

#include <vector>

#include "troupe/vec2.h"

namespace troupe {

// A robot nearby, in the frame R of this one.
struct Neighbour {
  Vec2 p_R{0.0, 0.0};    // m
  double heading = 0.0;  // rad
};

// Where to move, in R: ahead, in the mean direction of the neighbours, towards their middle if that is farther than
// `distance` m, and away from those that are nearer. The longer, the more urgent: 1 for ahead alone. Zero where nothing
// decides.
Vec2 FlockDirection(const std::vector<Neighbour>& neighbours, double distance);

// The share of the full speed at which to move there: one that has to catch up is faster than one that is pushed back.
double FlockSpeed(const Vec2& direction);

}  // namespace troupe
