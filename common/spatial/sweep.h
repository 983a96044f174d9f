// Sweep: the first contact of a body that moves along the arc of a constant twist.
//
// A body that also climbs or sinks overlaps another only while their heights do too; those times are closed as well.
//
// Exact: while body A moves with a constant twist, each of its vertices moves on a circle (a line without turning)
// about the instant centre of rotation, and, seen from A, each vertex of a static body B moves on a circle too. The two
// can begin or end to overlap only at the times at which a vertex of one touches an edge of the other; those times have
// closed forms. Between two neighbouring times nothing changes, so one test in each interval finds the first overlap.
// No speed is too fast and no wall too thin.
//
// Between two events the depth of an overlap may change, but not whether there is one; so the test in the middle of
// each interval decides for the whole interval. A contact is then the event at which the interval begins. Where a pair
// already overlaps, or heights and footprints decide together, the time is refined by bisection. The returned time is
// free: rounding is resolved by stepping back, so that a body never comes to rest inside another.
//
// Cost: pairs are thrown out by boxes, by heights, by a separating line for the whole motion (Passage), and by their
// gap at the start; the few that are left cost the product of their vertices. Memory is on the stack unless a motion
// has very many obstacles.
//
// Pure functions, for any thread with its own BodyIndex. Seconds count from the start of the motion.
#pragma once

#include <optional>
#include <span>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "troupe/ids.h"
#include "troupe/pose.h"

namespace troupe {

// The time at which convex polygon `a` (frame R, which starts at X_WR and moves with `twist`) first overlaps convex
// polygon `b` (frame W) by more than it does at the start, within [0, duration] seconds; nothing if it does not. Depths
// up to kTouchTolerance are touching. A pair that overlaps from the start (badly placed by a file) may move so that the
// overlap does not deepen, and so can end.
std::optional<double> TimeOfContact(std::span<const Vec2> a_in_R, const Pose& X_WR, const Twist& twist, double duration,
                                    std::span<const Vec2> b_in_W);

// A motion of frame F: along the arc of a constant twist, and up or down at a constant rate.
// REQUIRES, for FirstContact and FirstContactWith: a motion with climb != 0 turns by at most a full turn,
// |twist.wz| * duration <= 2 pi, since heights do not repeat as the arc does.
struct Motion {
  Pose X_WF;              // at the start
  Twist twist;            // in F
  double climb = 0.0;     // m/s, upwards
  double duration = 0.0;  // s

  bool IsRest() const { return (twist.IsZero() && climb == 0.0) || !(duration > 0.0); }
  // Pose of F after so many seconds.
  Pose After(double seconds) const;
};

// The pieces that move as one: a body, or a part of one with its payload.
struct Mover {
  std::span<const ConvexPiece> pieces;  // in F; those with `obstacle` collide
  double radius = 0.0;                  // m: no vertex is farther from F's origin
  ZRange z;                             // m, spans the pieces, in F
  std::span<const BodyId> bodies;       // its own: their pieces are no obstacles to it; ascending
};

// A whole body without joints, moving by itself. `body` must outlive the mover.
inline Mover MoverOf(const Scene& scene, const BodyId& body) {
  return {scene.body(body).pieces, scene.body(body).radius, scene.body(body).z, std::span(&body, 1)};
}

struct Contact {
  double time = 0.0;             // s after the start of the motion
  ModelId mine;                  // the mover's model in contact
  std::optional<ModelId> other;  // the obstacle; nothing: the ground
};

// The first contact of the mover with the static models and with the bodies at their poses in `bodies`. Models with
// obstacle_return collide. A mover with an obstacle below z = 0 is in contact with the ground unless it climbs. Of
// contacts at the same time the lowest model id counts.
std::optional<Contact> FirstContact(const Scene& scene, const BodyIndex& bodies, const Mover& mover,
                                    const Motion& motion);

// The same with `obstacles` alone, static pieces in W, and without the ground.
std::optional<Contact> FirstContactWith(std::span<const ConvexPiece> obstacles, const Mover& mover,
                                        const Motion& motion);

}  // namespace troupe
