// ConvexPiece: the unit of all geometric tests, a convex prism with the properties of the model that it belongs to.
//
// Concave outlines and bitmaps are cut into convex pieces when a scene is made, because every exact test (overlap,
// sweep, ray, nearest points) is short on convex polygons. Footprints and heights are independent of each other: two
// prisms overlap if and only if both do.
//
// Invariants: at least three vertices, counter-clockwise, of a polygon with an area; a height above kTouchTolerance. A
// model has as many pieces as its shape needs, and all of its properties that tests ask for are copied into each piece,
// so that a test reads one piece and no description.
#pragma once

#include <span>
#include <vector>

#include "troupe/ids.h"
#include "troupe/polygon.h"
#include "troupe/pose.h"
#include "troupe/vec2.h"
#include "troupe/world_description.h"
#include "troupe/z_range.h"

namespace troupe {

struct ConvexPiece {
  std::vector<Vec2> vertices;  // m, counter-clockwise; frame: W for static pieces, the link's L for a body's
  ZRange z;                    // m, in the same frame
  ModelId model;
  bool obstacle = true;
  double ranger_return = 1.0;  // negative: transparent
};

// False for a height interval that nothing collides with and no ray hits.
bool HasHeight(const ZRange& z);

// True for the vertices of a rectangle along the axes.
bool IsBox(std::span<const Vec2> vertices);

// The pieces of a model's shape, moved by X_FM into frame F, without the pieces of its area (static_index.h).
std::vector<ConvexPiece> MakePieces(const WorldDescription& world, ModelId model, const Pose& X_FM);

// `piece` moved by X_WF.
ConvexPiece Transformed(const ConvexPiece& piece, const Pose& X_WF);

// Overlap of convex polygons.

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

struct NearestPoints {
  double distance = 0.0;  // m; 0 if they touch or overlap
  Vec2 a{0.0, 0.0};       // m, a point of the first
  Vec2 b{0.0, 0.0};       // of the second; equal to `a` if they overlap
};

// The nearest points of two convex polygons, counter-clockwise. Two vertices are a segment, one is a point. REQUIRES:
// each has a vertex
// Cost: of two that are apart about the sum of the numbers of vertices, of others their product.
NearestPoints FindNearestPoints(std::span<const Vec2> a, std::span<const Vec2> b);

}  // namespace troupe
