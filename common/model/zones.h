// Zones of a site: their areas, and the cells of cleaning zones that count as covered.
//
// The cells of a zone are squares along x and y, row by row from the lower left corner of its bounding box; those whose
// middle is outside of the zone do not count. Their bits are rows of WorldState::coverage, 32 cells each, zone after
// zone in the order of the world; each zone begins a row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "troupe/world_state.h"

namespace troupe {

std::optional<std::size_t> FindZone(const WorldDescription& world, const std::string& name);

// A height is on the level of the zone; in a world without levels each is.
bool IsOnLevelOf(const WorldDescription& world, const ZoneDescription& zone, double z);
// A point on the level of the zone is in its area or on the edge of that.
bool IsInZone(const WorldDescription& world, const ZoneDescription& zone, const Vec2& point, double z);
// A straight way on the level of the zone has a point in its area.
bool CrossesZone(const WorldDescription& world, const ZoneDescription& zone, const Vec2& from, const Vec2& to,
                 double z);
// A motion along a vector in W, of any length, is against the traffic of a one_way zone: more than 90 degrees from its
// heading.
bool IsAgainst(const ZoneDescription& zone, const Vec2& along);

inline constexpr double kCoverageCell = 0.1;               // m, side of a cell
inline constexpr std::size_t kMaxCoverageCells = 1000000;  // of a zone

struct CoverageGrid {
  Vec2 corner{0.0, 0.0};                                            // m, lower left, in W
  std::size_t columns = 0;                                          // along x
  std::size_t rows = 0;                                             // along y
  std::size_t first = 0;                                            // row of WorldState::coverage
  std::size_t count() const { return (columns * rows + 31) / 32; }  // rows of the state
  Vec2 MiddleOf(std::size_t column, std::size_t row) const {
    return corner + kCoverageCell * Vec2(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
  }
};
// By zone; empty for one that is no cleaning zone.
std::vector<CoverageGrid> CoverageGrids(const WorldDescription& world);
// The rows of WorldState::coverage.
std::size_t CountCoverage(const WorldDescription& world);
// The cells of a cleaning zone.
std::size_t CountCells(const ZoneDescription& zone);
bool IsCovered(const WorldState& state, const CoverageGrid& grid, std::size_t column, std::size_t row);

}  // namespace troupe
