#include "common/geometry/convex_partition.h"

#include <array>
#include <map>
#include <utility>

namespace troupe {
namespace {

// Convex pieces as vertex indices of the polygon, counter-clockwise.
using Loop = std::vector<std::size_t>;

double TwiceArea(const Vec2& a, const Vec2& b, const Vec2& c) {
  return Cross(b - a, c - a);
}

// True if p is in the triangle or on its edge. A corner does not count: outlines may touch themselves.
bool InTriangle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& p) {
  if (p == a || p == b || p == c) return false;
  return TwiceArea(a, b, p) >= 0.0 && TwiceArea(b, c, p) >= 0.0 && TwiceArea(c, a, p) >= 0.0;
}

// Cuts triangles off a polygon, one convex corner ("ear") after another.
class EarClipper {
 public:
  explicit EarClipper(const Polygon& polygon) : polygon_(polygon), next_(polygon.size()), previous_(polygon.size()) {
    const std::size_t n = polygon.size();
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
  }

  std::vector<Loop> Clip() {
    std::vector<Loop> triangles;
    std::size_t remaining = polygon_.size();
    std::size_t at = 0;
    std::size_t refused = 0;
    while (remaining > 3) {
      // A whole round without an ear is possible only where an outline touches itself.
      if (refused > remaining) at = SmallestCorner(at);
      if (refused > remaining || IsEar(at)) {
        if (Area(at) > 0.0) triangles.push_back({previous_[at], at, next_[at]});
        next_[previous_[at]] = next_[at];
        previous_[next_[at]] = previous_[at];
        --remaining;
        refused = 0;
        at = next_[next_[at]];  // skipping one makes rounder pieces than a fan does
      } else {
        ++refused;
        at = next_[at];
      }
    }
    if (Area(at) > 0.0) triangles.push_back({previous_[at], at, next_[at]});
    return triangles;
  }

 private:
  double Area(std::size_t i) const { return TwiceArea(polygon_[previous_[i]], polygon_[i], polygon_[next_[i]]); }

  // The convex corner that cuts off the least; any corner if none is convex.
  std::size_t SmallestCorner(std::size_t any) const {
    std::size_t best = any;
    for (std::size_t i = next_[any]; i != any; i = next_[i]) {
      if (Area(i) >= 0.0 && (Area(best) < 0.0 || Area(i) < Area(best))) best = i;
    }
    return best;
  }

  bool IsEar(std::size_t i) const {
    const double area = Area(i);
    if (area == 0.0) return true;  // nothing to cut off: the corner is dropped
    if (area < 0.0) return false;
    const Vec2& a = polygon_[previous_[i]];
    const Vec2& b = polygon_[i];
    const Vec2& c = polygon_[next_[i]];
    for (std::size_t j = next_[next_[i]]; j != previous_[i]; j = next_[j]) {
      if (Area(j) <= 0.0 && InTriangle(a, b, c, polygon_[j])) return false;
    }
    return true;
  }

  const Polygon& polygon_;
  std::vector<std::size_t> next_;
  std::vector<std::size_t> previous_;
};

// Joins neighbouring pieces across every diagonal whose removal leaves the union convex.
class Merger {
 public:
  Merger(const Polygon& polygon, std::vector<Loop> pieces) : polygon_(polygon), pieces_(std::move(pieces)) {
    for (std::size_t piece = 0; piece < pieces_.size(); ++piece) Own(piece);
  }

  std::vector<Loop> Merge() {
    // A copy, in the order of vertices: merging changes the owners. Each diagonal is tried once, from its lower vertex.
    const std::map<Edge, std::size_t> edges = owner_;
    for (const auto& [edge, unused] : edges) {
      if (edge.first < edge.second) TryMerge(edge);
    }
    return std::move(pieces_);
  }

 private:
  using Edge = std::pair<std::size_t, std::size_t>;

  void Own(std::size_t piece) {
    const Loop& loop = pieces_[piece];
    for (std::size_t i = 0; i < loop.size(); ++i) owner_[{loop[i], loop[(i + 1) % loop.size()]}] = piece;
  }

  // The piece's vertices, starting behind the edge's end and ending at its start.
  static Loop RotatedBehind(const Loop& loop, const Edge& edge) {
    std::size_t start = 0;
    while (loop[start] != edge.second || loop[(start + loop.size() - 1) % loop.size()] != edge.first) ++start;
    Loop result;
    for (std::size_t i = 0; i < loop.size(); ++i) result.push_back(loop[(start + i) % loop.size()]);
    return result;
  }

  bool IsConvexAt(std::size_t before, std::size_t middle, std::size_t after) const {
    return TwiceArea(polygon_[before], polygon_[middle], polygon_[after]) >= 0.0;
  }

  void TryMerge(const Edge& edge) {
    const auto left = owner_.find(edge);
    const auto right = owner_.find({edge.second, edge.first});
    // An edge of the outline has a piece on one side only.
    if (left == owner_.end() || right == owner_.end() || left->second == right->second) return;
    const std::size_t left_piece = left->second;
    const std::size_t right_piece = right->second;
    // Left runs from edge.second round to edge.first, right from edge.first round to edge.second.
    Loop a = RotatedBehind(pieces_[left_piece], edge);
    const Loop b = RotatedBehind(pieces_[right_piece], {edge.second, edge.first});
    // Only the two ends of the diagonal could become concave.
    if (!IsConvexAt(a[a.size() - 2], edge.first, b[1])) return;
    if (!IsConvexAt(b[b.size() - 2], edge.second, a[1])) return;
    a.insert(a.end(), b.begin() + 1, b.end() - 1);
    pieces_[left_piece] = std::move(a);
    pieces_[right_piece].clear();
    owner_.erase(edge);
    owner_.erase({edge.second, edge.first});
    Own(left_piece);
  }

  const Polygon& polygon_;
  std::vector<Loop> pieces_;  // empty: merged into another
  std::map<Edge, std::size_t> owner_;
};

// REQUIRES: the polygon does not cross itself, so that it is convex if no corner turns right.
bool IsConvex(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (TwiceArea(polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n]) < 0.0) return false;
  }
  return true;
}

}  // namespace

std::vector<Polygon> ConvexPartition(const Polygon& polygon) {
  if (IsConvex(polygon)) return {polygon};
  std::vector<Polygon> result;
  for (const Loop& loop : Merger(polygon, EarClipper(polygon).Clip()).Merge()) {
    if (loop.empty()) continue;
    Polygon& piece = result.emplace_back();
    for (std::size_t index : loop) piece.push_back(polygon[index]);
  }
  return result;
}

}  // namespace troupe
