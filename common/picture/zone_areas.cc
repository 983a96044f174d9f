// The zones of a site in the view from above: their areas, and of a cleaning zone the cells on which robots were.
#include <algorithm>

#include "common/model/zones.h"
#include "common/picture/views.h"

namespace troupe {
namespace {

constexpr double kBelow = 0.5;  // m, of a zone below the lowest solid that is still on its level

Color ColorOf(ZoneKind kind) {
  switch (kind) {
    case ZoneKind::kKeepout:
      return {0.80, 0.16, 0.14, 1.0};
    case ZoneKind::kSpeed:
      return {0.88, 0.58, 0.08, 1.0};
    case ZoneKind::kOneWay:
      return {0.16, 0.36, 0.80, 1.0};
    case ZoneKind::kRelease:
      return {0.52, 0.24, 0.66, 1.0};
    case ZoneKind::kEvacuation:
      return {0.10, 0.55, 0.24, 1.0};
    case ZoneKind::kCleaning:
      break;
  }
  return {0.10, 0.52, 0.60, 1.0};
}

// Runs of covered cells, row by row.
std::vector<Polygon> CoveredRuns(const Drawing& drawing, const Viewport& viewport, const CoverageGrid& grid) {
  std::vector<Polygon> runs;
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns;) {
      std::size_t end = column;
      while (end < grid.columns && IsCovered(drawing.state, grid, end, row)) ++end;
      if (end > column) {
        const Vec2 low = grid.corner + kCoverageCell * Vec2(static_cast<double>(column), static_cast<double>(row));
        const Vec2 high = grid.corner + kCoverageCell * Vec2(static_cast<double>(end), static_cast<double>(row + 1));
        runs.push_back({viewport.ToPage(low), viewport.ToPage(high.x(), low.y()), viewport.ToPage(high),
                        viewport.ToPage(low.x(), high.y())});
      }
      column = end + 1;
    }
  }
  return runs;
}

}  // namespace

void DrawZones(Canvas& canvas, const Viewport& viewport, const Drawing& drawing) {
  if (drawing.world.zones.empty() || drawing.state.zones.size() != drawing.world.zones.size()) return;
  ZRange heights{0.0, 0.0};
  for (std::size_t i = 0; i < drawing.solids.size(); ++i) {
    const ZRange& z = drawing.solids[i].z;
    heights = i == 0 ? z : ZRange{std::min(heights.min, z.min), std::max(heights.max, z.max)};
  }
  const std::vector<CoverageGrid> grids = CoverageGrids(drawing.world);
  for (std::size_t i = 0; i < drawing.world.zones.size(); ++i) {
    const ZoneDescription& zone = drawing.world.zones[i];
    if (!drawing.solids.empty() && (zone.z < heights.min - kBelow || zone.z > heights.max)) continue;
    Polygon outline;
    for (const Vec2& corner : zone.outline) outline.push_back(viewport.ToPage(corner));
    const bool is_on = drawing.state.zones[i].is_on;
    const Color color = ColorOf(zone.kind);
    const bool is_cleaning = grids[i].count() > 0;
    if (is_cleaning) {
      canvas.FillUnion(CoveredRuns(drawing, viewport, grids[i]), WithOpacity(color, 0.45));
    } else if (is_on) {
      canvas.Fill(std::vector<Polygon>{outline}, WithOpacity(color, 0.16));
    }
    canvas.Stroke(std::vector<Polygon>{outline}, 1.6 * viewport.unit, WithOpacity(color, is_on ? 0.9 : 0.35));
  }
}

}  // namespace troupe
