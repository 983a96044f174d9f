// WalkPortals: the doors and lifts of a world as people use them: where a leaf sweeps, where people wait for a lift,
// get on, stand and get off. A pure function of the world.
//
// All geometry of doors and lifts that people need is computed here once, so that a decision only compares a few
// numbers. Leaves are taken from closed to open as one convex area: a person that is outside of it cannot be hit,
// whatever the door does.
//
// REQUIRES of users: a DoorPortal exists only for doors that people may ask for, a LiftStop only where people of the
// portal's radius find room in the cabin; both are optional.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "common/spatial/scene.h"
#include "troupe/rectangle.h"

namespace troupe {

// The radius (m) of a person and its body.
double RadiusOf(const Scene& scene, PersonId person);

// A door that people may ask for.
struct DoorPortal {
  std::vector<ConvexPiece> closed;          // its leaves, in W
  std::vector<std::vector<Vec2>> sweeps;    // by leaf: a convex area that contains it from closed to open
  std::vector<std::optional<Vec2>> hinges;  // by leaf; nothing for one that slides

  // The distance (m) of `p` from the sweeps, and the direction of length 1 that leads away from the nearest sweep; for
  // a point inside a sweep away from its hinge.
  struct Clearance {
    double distance = 0.0;
    Vec2 away{0.0, 0.0};
  };
  Clearance ClearanceOf(const Vec2& p) const;
};

// The doorway of a lift at a floor. Its frame U has its origin in the middle of the cabin's door, its x axis (u) points
// out of the cabin, y (v) to the left.
struct LiftStop {
  Vec2 door{0.0, 0.0};      // m, W
  Vec2 outward{1.0, 0.0};   // of length 1
  double z = 0.0;           // m, of the floor
  double half_width = 0.0;  // m, of the doorway
  double outside = 0.0;     // u, m: from there on a person touches no leaf
  double lane = 0.0;        // u, m: to there the way of people who get off is to be kept free

  Vec2 ToU(const Vec2& p) const {
    const Vec2 way = p - door;
    return {way.dot(outward), way.dot(Vec2(-outward.y(), outward.x()))};
  }
  Vec2 FromU(const Vec2& p_U) const { return door + p_U.x() * outward + p_U.y() * Vec2(-outward.y(), outward.x()); }
  // The point at which waiting people gather.
  Vec2 Entrance() const { return FromU({lane, 0.0}); }
};

struct LiftPortal {
  Pose X_WC;                                   // of the cabin at load
  Rectangle outline = Rectangle::Nothing();    // m, frame C
  double height = 0.0;                         // m, of the cabin's top above its floor
  std::vector<std::optional<LiftStop>> stops;  // by floor; nothing where people cannot get on
  std::vector<Vec2> places;  // m, W: where people stand; along the walls, so that the way to the door is free
  double radius = 0.0;       // m, of the widest people that the places are for: wider ones do not ride

  // True for a person at `p`, `above` m above the floor of the cabin.
  bool IsInside(const Vec2& p, double above) const;
  // The number of the floor at height `z`, if it has a stop.
  std::optional<std::uint32_t> FloorAt(double z) const;
};

// Heights (m) that are so near to each other are one level.
inline constexpr double kSameLevel = 0.25;

struct WalkPortals {
  explicit WalkPortals(const Scene& scene);

  std::vector<std::optional<DoorPortal>> doors;  // by door; nothing for one that is not operated
  std::vector<LiftPortal> lifts;                 // by lift
  // Further walls for people: cabins, at all heights, and the leaves of doors that are never operated; in W.
  std::vector<ConvexPiece> walls;
  // The leaves of open doors, in W: people walk around them if they can, whether the door is open or not.
  std::vector<ConvexPiece> open_leaves;
};

}  // namespace troupe
