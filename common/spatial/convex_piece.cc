#include "common/spatial/convex_piece.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/convex_partition.h"

namespace troupe {
namespace {

ConvexPiece Moved(std::vector<Vec2> vertices, const ZRange& z, const ModelDescription& model, ModelId id,
                  const Pose& X_FM) {
  const Transform2 transform(X_FM);
  for (Vec2& vertex : vertices) vertex = transform * vertex;
  return {.vertices = std::move(vertices),
          .z = z + X_FM.z,
          .model = id,
          .obstacle = model.obstacle_return,
          .ranger_return = model.ranger_return};
}

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// The gaps between `a` and `b` along the outward normals of a's edges, negative where they overlap, until visit(gap)
// returns false; then false.
template <typename Visit>
bool ForEachGap(std::span<const Vec2> a, std::span<const Vec2> b, Visit visit) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec2& start = a[i];
    const Vec2 along = a[i + 1 < a.size() ? i + 1 : 0] - start;
    const double length = std::sqrt(along.squaredNorm());
    // Two vertices may coincide after the rounding of a transform: such an edge has no normal.
    if (length == 0.0) continue;
    double gap = kUnbounded;
    for (const Vec2& vertex : b) gap = std::min(gap, -Cross(along, vertex - start));
    if (!visit(gap / length)) return false;
  }
  return true;
}

// The distances of points beyond the line along `along` through `start`, on its outer side, times its length: the least
// and the most.
struct Beyond {
  double least = kUnbounded;
  double most = -kUnbounded;

  void Add(const Vec2& start, const Vec2& along, std::span<const Vec2> points) {
    for (const Vec2& point : points) {
      const double beyond = -Cross(along, point - start);
      least = std::min(least, beyond);
      most = std::max(most, beyond);
    }
  }
};

// `gap`: times the length of `along`. Without a root or a division.
// Both sides are compared as squares.
bool IsMoreThan(double gap, double margin, const Vec2& along) {
  return gap > 0.0 && gap * gap > margin * margin * along.squaredNorm();
}

Vec2 NearestOnEdge(const Vec2& point, const Vec2& from, const Vec2& to) {
  const Vec2 along = to - from;
  const double square = along.squaredNorm();
  if (square == 0.0) return from;
  return from + std::clamp((point - from).dot(along) / square, 0.0, 1.0) * along;
}

// For three vertices or more.
bool IsInside(std::span<const Vec2> polygon, const Vec2& point) {
  if (polygon.size() < 3) return false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& from = polygon[i];
    const Vec2& to = polygon[(i + 1) % polygon.size()];
    if (Cross(to - from, point - from) < 0.0) return false;
  }
  return true;
}

// True if the inner parts of two edges cross, at `at`.
bool EdgesCross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, Vec2& at) {
  const double c_side = troupe::Cross(b - a, c - a);
  const double d_side = troupe::Cross(b - a, d - a);
  const double a_side = troupe::Cross(d - c, a - c);
  const double b_side = troupe::Cross(d - c, b - c);
  if (!((c_side < 0.0) != (d_side < 0.0) && (a_side < 0.0) != (b_side < 0.0))) return false;
  // Parallel: ends on the line are found as nearest points.
  if (c_side == d_side) return false;
  at = c + (d - c) * (c_side / (c_side - d_side));
  return true;
}

// Two polygons as seen along the line between their middles: where each begins and ends there, in m from a's first
// vertex. If they are apart on that line, only the vertices and edges that face each other can have the nearest points.
class Facing {
 public:
  Facing(std::span<const Vec2> a, std::span<const Vec2> b) : origin_(a.front()) {
    if (a.size() < 3 || b.size() < 3) return;  // so few pairs of parts cost no more than a look along a line
    Vec2 middle_a(0.0, 0.0);
    Vec2 middle_b(0.0, 0.0);
    for (const Vec2& vertex : a) middle_a += vertex - origin_;
    for (const Vec2& vertex : b) middle_b += vertex - origin_;
    along_ = middle_b / static_cast<double>(b.size()) - middle_a / static_cast<double>(a.size());
    const double length = along_.norm();
    if (!(length > 0.0)) return;
    along_ /= length;
    const auto last_of_a =
        std::max_element(a.begin(), a.end(), [&](const Vec2& p, const Vec2& q) { return At(p) < At(q); });
    const auto first_of_b =
        std::min_element(b.begin(), b.end(), [&](const Vec2& p, const Vec2& q) { return At(p) < At(q); });
    end_of_a_ = At(*last_of_a);
    begin_of_b_ = At(*first_of_b);
    // Rounding is far below the margin, so that the nearest points are never passed over.
    reach_ = (*first_of_b - *last_of_a).norm() * (1.0 + kMargin) + kMargin;
    are_apart_ = begin_of_b_ - end_of_a_ > kMargin;
  }

  bool are_apart() const { return are_apart_; }
  // Whether a part of `a` that ends at `end_of_a` can be near enough to one of `b` that begins at `begin_of_b`.
  bool CanBeNearest(double end_of_a, double begin_of_b) const { return !are_apart_ || begin_of_b - end_of_a <= reach_; }
  double At(const Vec2& point) const { return (point - origin_).dot(along_); }
  double begin_of_b() const { return begin_of_b_; }

 private:
  static constexpr double kMargin = 1e-9;  // m, and as a part of the reach

  Vec2 origin_;
  Vec2 along_{0.0, 0.0};
  double end_of_a_ = 0.0;
  double begin_of_b_ = 0.0;
  double reach_ = 0.0;  // m, an upper bound of the distance
  bool are_apart_ = false;
};

}  // namespace

bool HasHeight(const ZRange& z) {
  return z.max - z.min > kTouchTolerance;
}

bool IsBox(std::span<const Vec2> vertices) {
  if (vertices.size() != 4) return false;
  const Rectangle box = BoundingBox(vertices);
  return std::all_of(vertices.begin(), vertices.end(), [&](const Vec2& p) {
    return (p.x() == box.min_x || p.x() == box.max_x) && (p.y() == box.min_y || p.y() == box.max_y);
  });
}

// In the order of blocks, then of rectangles: the numbers of pieces are the same in every process.
std::vector<ConvexPiece> MakePieces(const WorldDescription& world, ModelId id, const Pose& X_FM) {
  const ModelDescription& model = world.model(id);
  const Shape& shape = world.shape(model.shape);
  std::vector<ConvexPiece> pieces;
  for (const Block& block : shape.blocks) {
    if (!HasHeight(block.z)) continue;
    for (Polygon& part : ConvexPartition(block.outline)) {
      pieces.push_back(Moved(std::move(part), block.z, model, id, X_FM));
    }
  }
  if (HasHeight(shape.rectangles_z)) {
    pieces.reserve(pieces.size() + shape.rectangles.size());
    for (const Rectangle& r : shape.rectangles) {
      const std::array<Vec2, 4> corners = Corners(r);
      pieces.push_back(Moved({corners.begin(), corners.end()}, shape.rectangles_z, model, id, X_FM));
    }
  }
  return pieces;
}

ConvexPiece Transformed(const ConvexPiece& piece, const Pose& X_WF) {
  ConvexPiece result = piece;
  const Transform2 transform(X_WF);
  for (Vec2& vertex : result.vertices) vertex = transform * vertex;
  result.z = piece.z + X_WF.z;
  return result;
}

double PenetrationDepth(std::span<const Vec2> a, std::span<const Vec2> b) {
  double largest = -kUnbounded;
  const auto keep_largest = [&largest](double gap) {
    largest = std::max(largest, gap);
    return true;
  };
  ForEachGap(a, b, keep_largest);
  ForEachGap(b, a, keep_largest);
  return -largest;
}

bool OverlapBy(std::span<const Vec2> a, std::span<const Vec2> b, double depth) {
  const auto overlaps = [depth](double gap) { return -gap > depth; };
  // Ends at the first normal that shows a gap: most pairs are apart.
  return ForEachGap(a, b, overlaps) && ForEachGap(b, a, overlaps);
}

bool StayApart(std::span<const Vec2> a, std::span<const Vec2> a_later, std::span<const Vec2> b, double margin) {
  for (std::size_t i = 0; i < b.size(); ++i) {
    const Vec2 along = b[i + 1 < b.size() ? i + 1 : 0] - b[i];
    Beyond mover;
    mover.Add(b[i], along, a);
    mover.Add(b[i], along, a_later);
    if (IsMoreThan(mover.least, margin, along)) return true;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec2 along = a[i + 1 < a.size() ? i + 1 : 0] - a[i];
    Beyond mover;
    mover.Add(a[i], along, a);
    mover.Add(a[i], along, a_later);
    Beyond obstacle;
    obstacle.Add(a[i], along, b);
    if (IsMoreThan(obstacle.least - mover.most, margin, along)) return true;
  }
  return false;
}

bool OverlapBy(const ConvexPiece& a, const ConvexPiece& b, double depth) {
  return a.z.Overlaps(b.z) && OverlapBy(a.vertices, b.vertices, depth);
}

NearestPoints FindNearestPoints(std::span<const Vec2> a, std::span<const Vec2> b) {
  const Facing facing(a, b);
  // One polygon inside the other: no edges cross.
  if (!facing.are_apart() && IsInside(b, a.front())) return {0.0, a.front(), a.front()};
  if (!facing.are_apart() && IsInside(a, b.front())) return {0.0, b.front(), b.front()};
  NearestPoints nearest{std::numeric_limits<double>::infinity(), a.front(), b.front()};
  const auto keep = [&](const Vec2& of_a, const Vec2& of_b) {
    const double distance = (of_a - of_b).norm();
    if (distance < nearest.distance) nearest = {distance, of_a, of_b};
  };
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec2& a_from = a[i];
    const Vec2& a_to = a[i + 1 < a.size() ? i + 1 : 0];
    const double end_of_edge = std::max(facing.At(a_from), facing.At(a_to));
    if (!facing.CanBeNearest(end_of_edge, facing.begin_of_b())) continue;
    for (std::size_t k = 0; k < b.size(); ++k) {
      const Vec2& b_from = b[k];
      const Vec2& b_to = b[k + 1 < b.size() ? k + 1 : 0];
      if (!facing.CanBeNearest(end_of_edge, std::min(facing.At(b_from), facing.At(b_to)))) continue;
      Vec2 at;
      if (!facing.are_apart() && EdgesCross(a_from, a_to, b_from, b_to, at)) return {0.0, at, at};
      keep(a_from, NearestOnEdge(a_from, b_from, b_to));
      keep(NearestOnEdge(b_from, a_from, a_to), b_from);
    }
  }
  return nearest;
}

}  // namespace troupe
