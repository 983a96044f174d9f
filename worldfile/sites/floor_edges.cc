#include "worldfile/sites/floor_edges.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "troupe/deterministic_math.h"
#include "troupe/interval.h"
#include "troupe/polygon.h"
#include "troupe/rectangle.h"

namespace troupe {
namespace {

constexpr double kGap = 0.3;                    // m, between floors that are one
constexpr double kAtWall = 0.2;                 // m, from the line of a wall
constexpr double kMinLength = 0.1;              // m, of an edge
constexpr std::size_t kMaxPairs = 100'000'000;  // of edges with walls and edges

Rectangle BoxOf(const Polygon& polygon) {
  Rectangle box = Rectangle::Nothing();
  for (const Vec2& vertex : polygon) box.Extend(vertex);
  return box;
}

// A convex or concave area that covers parts of edges.
struct Cover {
  Polygon outline;
  Rectangle box;
};

Cover CoverOf(Polygon outline) {
  const Rectangle box = BoxOf(outline);
  return {std::move(outline), box};
}

// Appends the parts of the way from `from` to `to` that are in an area, as shares of the way.
// The way is cut where it crosses the outline; each part is inside or outside as its middle is.
void AppendCovered(const Vec2& from, const Vec2& to, const Cover& cover, std::vector<Interval>& covered) {
  Rectangle box = Rectangle::Nothing();
  box.Extend(from);
  box.Extend(to);
  if (!box.Inflated(1e-6).Overlaps(cover.box)) return;
  const Vec2 way = to - from;
  std::vector<double> cuts{0.0, 1.0};
  for (std::size_t i = 0; i < cover.outline.size(); ++i) {
    const Vec2& a = cover.outline[i];
    const Vec2 side = cover.outline[(i + 1) % cover.outline.size()] - a;
    const double turn = Cross(way, side);
    if (turn == 0.0) continue;
    const double at = Cross(Vec2(a - from), side) / turn;
    if (at > 0.0 && at < 1.0) cuts.push_back(at);
  }
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    if (Contains(cover.outline, from + 0.5 * (cuts[i] + cuts[i + 1]) * way)) covered.push_back({cuts[i], cuts[i + 1]});
  }
}

// A rectangle in frame F.
Polygon OutlineOf(const Pose& X_WF, double half_x, double half_y) {
  const Transform2 to_world(X_WF);
  return {to_world * Vec2(-half_x, -half_y), to_world * Vec2(half_x, -half_y), to_world * Vec2(half_x, half_y),
          to_world * Vec2(-half_x, half_y)};
}

}  // namespace

// An edge is open where no wall is on it and no other floor or cabin begins behind it. The lowest level has ground
// everywhere. A building beyond kMaxPairs has no edges rather than a slow start.
std::vector<FloorEdge> FindFloorEdges(const Site& site, const SiteLevel& level) {
  const bool is_lowest = std::none_of(site.levels.begin(), site.levels.end(),
                                      [&](const SiteLevel& other) { return other.elevation < level.elevation; });
  if (is_lowest) return {};
  std::vector<Cover> floors;
  std::size_t corners = 0;
  for (const SiteFloor& floor : level.floors) {
    Polygon outline;
    for (const std::size_t vertex : floor.vertices) outline.push_back(level.vertices[vertex].position);
    Result<Polygon> normalized = Normalized(std::move(outline));
    if (!normalized.ok()) continue;
    corners += normalized.value().size();
    floors.push_back(CoverOf(std::move(normalized).value()));
  }
  if (corners * (corners + level.walls.size() + site.lifts.size()) > kMaxPairs) return {};
  std::vector<Cover> walls;
  for (const SiteEdge& wall : level.walls) {
    const Vec2& a = level.vertices[wall.start].position;
    const Vec2 way = level.vertices[wall.end].position - a;
    const double length = way.norm();
    if (length == 0.0) continue;
    const Vec2 middle = a + 0.5 * way;
    walls.push_back(
        CoverOf(OutlineOf({middle.x(), middle.y(), 0.0, Atan2(way.y(), way.x())}, 0.5 * length + kAtWall, kAtWall)));
  }
  std::vector<Cover> beyond = floors;
  for (const SiteLift& lift : site.lifts) {
    beyond.push_back(CoverOf(OutlineOf(lift.X_WC, 0.5 * lift.width + kGap, 0.5 * lift.depth + kGap)));
  }
  std::vector<FloorEdge> edges;
  for (const Cover& floor : floors) {
    for (std::size_t i = 0; i < floor.outline.size(); ++i) {
      const Vec2& from = floor.outline[i];
      const Vec2& to = floor.outline[(i + 1) % floor.outline.size()];
      const Vec2 way = to - from;
      const double length = way.norm();
      const Vec2 outwards = kGap / length * Vec2(way.y(), -way.x());  // outlines are counter-clockwise
      std::vector<Interval> covered;
      for (const Cover& wall : walls) AppendCovered(from, to, wall, covered);
      for (const Cover& area : beyond) AppendCovered(from + outwards, to + outwards, area, covered);
      std::sort(covered.begin(), covered.end(), [](const Interval& a, const Interval& b) { return a.min < b.min; });
      covered.push_back({1.0, 1.0});
      double end = 0.0;  // of what is covered so far
      for (const Interval& part : covered) {
        if ((part.min - end) * length >= kMinLength) edges.push_back({from + end * way, from + part.min * way});
        end = std::max(end, part.max);
      }
    }
  }
  return edges;
}

}  // namespace troupe
