#include "common/model/zones.h"

#include <algorithm>
#include <cmath>

#include "troupe/deterministic_math.h"
#include "troupe/polygon.h"
#include "troupe/rectangle.h"

namespace troupe {
namespace {

constexpr double kAcross = 1e-9;  // cosine: a motion across the heading is not against it, whatever its last bits

bool Cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const auto side = [](const Vec2& from, const Vec2& to, const Vec2& p) {
    return (to.x() - from.x()) * (p.y() - from.y()) - (to.y() - from.y()) * (p.x() - from.x());
  };
  return side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
}

CoverageGrid GridOf(const ZoneDescription& zone) {
  if (zone.kind != ZoneKind::kCleaning) return {};
  const Rectangle box = BoundingBox(zone.outline);
  const auto cells = [](double length) {
    return static_cast<std::size_t>(std::max(1.0, std::ceil(length / kCoverageCell - 1e-9)));
  };
  return {
      .corner = {box.min_x, box.min_y}, .columns = cells(box.max_x - box.min_x), .rows = cells(box.max_y - box.min_y)};
}

}  // namespace

std::optional<std::size_t> FindZone(const WorldDescription& world, const std::string& name) {
  const auto found =
      std::find_if(world.zones.begin(), world.zones.end(), [&](const auto& zone) { return zone.name == name; });
  if (found == world.zones.end()) return std::nullopt;
  return static_cast<std::size_t>(found - world.zones.begin());
}

bool IsOnLevelOf(const WorldDescription& world, const ZoneDescription& zone, double z) {
  return world.levels.empty() || LevelAt(world.levels, zone.z) == LevelAt(world.levels, z);
}

bool IsInZone(const WorldDescription& world, const ZoneDescription& zone, const Vec2& point, double z) {
  return IsOnLevelOf(world, zone, z) && Contains(zone.outline, point);
}

bool CrossesZone(const WorldDescription& world, const ZoneDescription& zone, const Vec2& from, const Vec2& to,
                 double z) {
  if (!IsOnLevelOf(world, zone, z)) return false;
  if (Contains(zone.outline, from) || Contains(zone.outline, to)) return true;
  for (std::size_t i = 0; i < zone.outline.size(); ++i) {
    if (Cross(from, to, zone.outline[i], zone.outline[(i + 1) % zone.outline.size()])) return true;
  }
  return false;
}

bool IsAgainst(const ZoneDescription& zone, const Vec2& along) {
  const SinCosResult heading = SinCos(zone.heading);
  return along.dot(Vec2(heading.cos, heading.sin)) < -kAcross * along.norm();
}

std::vector<CoverageGrid> CoverageGrids(const WorldDescription& world) {
  std::vector<CoverageGrid> grids;
  std::size_t first = 0;
  for (const ZoneDescription& zone : world.zones) {
    CoverageGrid grid = GridOf(zone);
    grid.first = first;
    first += grid.count();
    grids.push_back(grid);
  }
  return grids;
}

std::size_t CountCoverage(const WorldDescription& world) {
  std::size_t count = 0;
  for (const ZoneDescription& zone : world.zones) count += GridOf(zone).count();
  return count;
}

std::size_t CountCells(const ZoneDescription& zone) {
  const CoverageGrid grid = GridOf(zone);
  std::size_t count = 0;
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns; ++column) {
      count += Contains(zone.outline, grid.MiddleOf(column, row)) ? 1 : 0;
    }
  }
  return count;
}

bool IsCovered(const WorldState& state, const CoverageGrid& grid, std::size_t column, std::size_t row) {
  const std::size_t cell = row * grid.columns + column;
  return (state.coverage[grid.first + cell / 32].cells >> (cell % 32) & 1U) != 0;
}

}  // namespace troupe
