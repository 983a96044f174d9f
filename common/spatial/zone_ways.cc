#include "common/spatial/zone_ways.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/point_distance.h"
#include "common/model/zones.h"
#include "troupe/polygon.h"

namespace troupe {
namespace {

// m, from the area of a zone; 0 in it.
double DistanceToZone(const ZoneDescription& zone, const Vec2& p) {
  return Contains(zone.outline, p) ? 0.0 : DistanceToEdges(zone.outline, p);
}

// Visits the cells whose centres are in a polygon, row by row between its edges.
template <typename Visit>
void ForEachInside(const WalkGrid& grid, const std::vector<Vec2>& outline, Visit visit) {
  const Rectangle box = BoundingBox(outline);
  std::vector<double> crossings;
  for (int row = grid.RowAt(box.min_y); row <= grid.RowAt(box.max_y); ++row) {
    const double y = grid.CenterOf(grid.CellAt(0, row)).y();
    crossings.clear();
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vec2& a = outline[i];
      const Vec2& b = outline[(i + 1) % outline.size()];
      if ((a.y() <= y) == (b.y() <= y)) continue;
      crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      for (int column = grid.ColumnAt(crossings[i]); column <= grid.ColumnAt(crossings[i + 1]); ++column) {
        const std::size_t cell = grid.CellAt(column, row);
        const double x = grid.CenterOf(cell).x();
        if (x >= crossings[i] && x <= crossings[i + 1]) visit(cell);
      }
    }
  }
}

// Visits the cells whose centres are nearer than `reach` m to the edges of a polygon, some of them several times.
template <typename Visit>
void ForEachAtEdge(const WalkGrid& grid, const std::vector<Vec2>& outline, double reach, Visit visit) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2& a = outline[i];
    const Vec2& b = outline[(i + 1) % outline.size()];
    for (int row = grid.RowAt(std::min(a.y(), b.y()) - reach); row <= grid.RowAt(std::max(a.y(), b.y()) + reach);
         ++row) {
      const int last = grid.ColumnAt(std::max(a.x(), b.x()) + reach);
      for (int column = grid.ColumnAt(std::min(a.x(), b.x()) - reach); column <= last; ++column) {
        const std::size_t cell = grid.CellAt(column, row);
        if (DistanceToSegment(grid.CenterOf(cell), a, b) < reach) visit(cell);
      }
    }
  }
}

bool LimitsWays(ZoneKind kind) {
  return kind == ZoneKind::kKeepout || kind == ZoneKind::kOneWay;
}

}  // namespace

ZoneWays::ZoneWays(const WorldDescription& world, const WorldState& state, double z, const WalkGrid& grid)
    : world_(world), z_(z) {
  for (std::size_t i = 0; i < world.zones.size(); ++i) {
    const ZoneDescription& zone = world.zones[i];
    if (!LimitsWays(zone.kind) || !state.zones[i].is_on || !IsOnLevelOf(world, zone, z)) continue;
    if (zone.kind == ZoneKind::kKeepout) {
      closed_.resize(grid.cell_count(), false);
      const auto close = [&](std::size_t cell) { closed_[cell] = true; };
      ForEachInside(grid, zone.outline, close);
      ForEachAtEdge(grid, zone.outline, grid.radius(), close);
      continue;
    }
    one_way_.push_back(i);
    against_.resize(grid.cell_count(), 0);
    std::uint8_t steps = 0;
    for (std::size_t step = 0; step < WalkGrid::kSteps.size(); ++step) {
      const Vec2 along(WalkGrid::kSteps[step].columns, WalkGrid::kSteps[step].rows);
      if (IsAgainst(zone, along)) steps = static_cast<std::uint8_t>(steps | (1U << step));
    }
    ForEachInside(grid, zone.outline,
                  [&](std::size_t cell) { against_[cell] = static_cast<std::uint8_t>(against_[cell] | steps); });
  }
}

bool ZoneWays::MayDrive(const Vec2& from, const Vec2& to) const {
  return std::none_of(one_way_.begin(), one_way_.end(), [&](std::size_t i) {
    const ZoneDescription& zone = world_.zones[i];
    return IsAgainst(zone, to - from) && CrossesZone(world_, zone, from, to, z_);
  });
}

std::vector<bool> ZonesOnWays(const WorldDescription& world, const WorldState& state) {
  std::vector<bool> on;
  for (std::size_t i = 0; i < world.zones.size(); ++i) {
    on.push_back(LimitsWays(world.zones[i].kind) && state.zones[i].is_on);
  }
  return on;
}

double RoomBeforeRelease(const WorldDescription& world, const WorldState& state, const Vec2& here,
                         const std::vector<Vec2>& points, std::size_t next, double z, double radius, double step,
                         double most) {
  double room = most;
  for (std::size_t i = 0; i < world.zones.size(); ++i) {
    const ZoneDescription& zone = world.zones[i];
    if (zone.kind != ZoneKind::kRelease || !state.zones[i].is_on || !IsOnLevelOf(world, zone, z)) continue;
    const double now = DistanceToZone(zone, here);
    if (now == 0.0 || now > most + radius) continue;  // one that is in it leaves it
    double before = 0.0;
    Vec2 from = here;
    for (std::size_t p = next; p < points.size() && before < room; ++p) {
      const Vec2 way = points[p] - from;
      const double length = way.norm();
      const int parts = static_cast<int>(length / step) + 1;
      for (int part = 1; part <= parts; ++part) {
        const double distance = DistanceToZone(zone, from + (static_cast<double>(part) / parts) * way);
        if (distance >= radius || distance >= now) continue;
        room = std::min(room, before + (part - 1) * length / parts);
        break;
      }
      before += length;
      from = points[p];
    }
  }
  return room;
}

}  // namespace troupe
