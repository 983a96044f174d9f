// The times of a motion with a constant twist at which a vertex touches an edge: only then can two polygons begin or
// end to overlap.
//
// Events are candidates, not contacts: sweep.cc tests between them. So an event too many does no harm, and the
// tolerances here are on the side of finding one; an event that is missed would let a body through a wall.
#pragma once

#include <memory_resource>
#include <span>
#include <vector>

#include "troupe/pose.h"
#include "troupe/vec2.h"

namespace troupe {

// Appends to `times` the times in [0, duration] (s) at which a vertex of `a` touches an edge of `b` or a vertex of `b`
// an edge of `a`, in no particular order; times may repeat, and some may belong to near misses. Both polygons are in
// the frame F at the start of the motion; `a` moves, `b` is static. A vertex that glides along an edge does not count.
// REQUIRES: |wz| * duration <= 2 pi
void AppendEvents(std::span<const Vec2> a, std::span<const Vec2> b, const Twist& twist, double duration,
                  std::pmr::vector<double>& times);

}  // namespace troupe
