// Overlap of convex polygons.
#pragma once

#include <span>

#include "common/spatial/convex_piece.h"
#include "troupe/vec2.h"

namespace troupe {

// The depth to which two convex, counter-clockwise polygons overlap: the smallest distance (m) by which one of them
// would have to move to be free (separating axis theorem). Zero or negative if they do not overlap in area; then its
// size is a lower bound of their distance.
double PenetrationDepth(std::span<const Vec2> a, std::span<const Vec2> b);

// True if the normal of an edge of `a` or `b` shows that `b` is farther than `margin`, in m, from the hull of `a` and
// `a_later`, the same polygon moved. Normals of `a_later` would show a little more, for a third of the price.
bool StayApart(std::span<const Vec2> a, std::span<const Vec2> a_later, std::span<const Vec2> b, double margin);

// Placing by hand and rounding in a file make small overlaps that are neither intended nor visible.
inline constexpr double kNoticeableDepth = 1e-6;  // m

// True if PenetrationDepth(a, b) > depth; quicker.
bool OverlapBy(std::span<const Vec2> a, std::span<const Vec2> b, double depth);

// True if pieces in the same frame share a height, and overlap in the plane by more than `depth`, in m.
bool OverlapBy(const ConvexPiece& a, const ConvexPiece& b, double depth);

}  // namespace troupe
