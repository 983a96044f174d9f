// Sweep: how far a body gets along the arc of a constant twist before it first overlaps something.
//
// A body that also climbs or sinks overlaps another only while their heights do too; those times are closed as well.
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
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"

namespace troupe {

// The time at which convex polygon `a` (frame R, which starts at X_WR and moves with `twist`) first overlaps convex
// polygon `b` (frame W) by more than it does at the start, within [0, duration] seconds; nothing if it does not. Depths
// up to kTouchTolerance are touching. A pair that overlaps from the start (badly placed by a file) may move so that the
// overlap does not deepen, and so can come free.
std::optional<double> TimeOfContact(std::span<const Vec2> a_in_R, const Pose& X_WR, const Twist& twist, double duration,
                                    std::span<const Vec2> b_in_W);

// A motion of frame F: along the arc of a constant twist, and up or down at a constant rate. REQUIRES, where contacts
// are looked for: it climbs, or turns more than once round, but not both.
struct Motion {
  Pose X_WF;              // at the start
  Twist twist;            // in F
  double climb = 0.0;     // m/s, upwards
  double duration = 0.0;  // s

  bool IsRest() const { return (twist.IsZero() && climb == 0.0) || !(duration > 0.0); }
  // Pose of F after so many seconds.
  Pose After(double seconds) const;
};

// What moves as one.
struct Mover {
  std::span<const ConvexPiece> pieces;  // in F; those with `obstacle` take part
  double radius = 0.0;                  // m: no vertex is farther from F's origin
  ZRange z;                             // m, spans the pieces, in F
  std::span<const BodyId> bodies;       // whose pieces are no obstacles to it, in order
};

// A whole body without joints, moving by itself. Good while `body` lives.
inline Mover MoverOf(const Scene& scene, const BodyId& body) {
  return {scene.body(body).pieces, scene.body(body).radius, scene.body(body).z, std::span(&body, 1)};
}

struct Contact {
  double time = 0.0;             // s after the start of the motion
  ModelId mine;                  // the mover's model that met something
  std::optional<ModelId> other;  // what was met; nothing: the ground
};

// The first contact of the mover with the standing models and with the bodies where `bodies` says they are. Models with
// obstacle_return take part. A mover with an obstacle below z = 0 is in contact with the ground unless it climbs. Of
// contacts at the same time the lowest model id counts.
std::optional<Contact> FirstContact(const Scene& scene, const BodyIndex& bodies, const Mover& mover,
                                    const Motion& motion);

// The same with nothing but `standing`, pieces in W, and without the ground.
std::optional<Contact> FirstContactWith(std::span<const ConvexPiece> standing, const Mover& mover,
                                        const Motion& motion);

}  // namespace troupe
