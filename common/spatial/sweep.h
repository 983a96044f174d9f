// Sweep: how far a body gets along the arc of a constant twist before it first overlaps something.
//
// Exact: while body A moves with a constant twist, each of its vertices moves on a circle (a line without turning)
// about the instant centre of rotation, and, seen from A, each vertex of a standing body B moves on a circle too.
// Whether the two overlap can change only when a vertex of one meets an edge of the other; those times have closed
// forms. Between two neighbouring times nothing changes, so one look at each interval finds the first one with overlap.
// No speed is too fast and no wall too thin.
#pragma once

#include <optional>
#include <span>

#include "common/base/ids.h"
#include "common/geometry/pose.h"
#include "common/spatial/robot_index.h"
#include "common/spatial/scene.h"

namespace troupe {

// The time at which convex polygon `a` (frame R, which starts at X_WR and moves with `twist`) first overlaps convex
// polygon `b` (frame W) by more than it does at the start, within [0, duration] seconds; nothing if it does not. Depths
// up to kTouchTolerance are touching. A pair that overlaps from the start (badly placed by a file) may move so that the
// overlap does not deepen, and so can come free.
std::optional<double> TimeOfContact(std::span<const Vec2> a_in_R, const Pose& X_WR, const Twist& twist, double duration,
                                    std::span<const Vec2> b_in_W);

struct Contact {
  double time = 0.0;             // s after the start of the motion
  std::optional<ModelId> other;  // what was met; nothing: the ground
};

// The first contact of `robot`'s whole tree, moving from X_WR under `twist` for `duration` seconds, with the standing
// models and the other robots where `robots` says they are. Models with obstacle_return take part. A tree with an
// obstacle below z = 0 is in contact with the ground whenever it moves. Of contacts at the same time the lowest model
// id counts.
std::optional<Contact> FirstContact(const Scene& scene, const RobotIndex& robots, RobotId robot, const Pose& X_WR,
                                    const Twist& twist, double duration);

}  // namespace troupe
