// ZoneWays: what the zones of a world that are on mean for the way of a robot on a WalkGrid.
//
// A robot keeps its whole body out of keepout zones: their cells are closed, with all within its radius of them. A
// robot inside leaves the zone by the shortest way, and does not come back. In a one_way zone it makes no step against
// the heading.
//
// Constant after construction; a pure function of its arguments. Cost: the cells in the zones and along their edges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/spatial/walk_grid.h"
#include "troupe/vec2.h"
#include "troupe/world_state.h"

namespace troupe {

class ZoneWays {
 public:
  // For a robot at the height z (m, W) with the radius of the grid. The grid and the world outlive it.
  ZoneWays(const WorldDescription& world, const WorldState& state, double z, const WalkGrid& grid);

  // No zone that is on limits ways at that height.
  bool empty() const { return closed_.empty() && against_.empty(); }

  bool IsClosed(std::size_t cell) const { return !closed_.empty() && closed_[cell]; }
  // By cell; empty: none is.
  const std::vector<bool>& closed() const { return closed_; }
  // The step of that number (WalkGrid::kSteps) is allowed: not into a closed cell, but from another one, and not
  // against the traffic of a one_way zone.
  bool MayStep(std::size_t from, std::size_t to, std::size_t number) const {
    if (!closed_.empty() && closed_[to] && !closed_[from]) return false;
    return against_.empty() || (((against_[from] | against_[to]) >> number) & 1U) == 0;
  }
  // A straight way in W is nowhere against the traffic of a one_way zone.
  bool MayDrive(const Vec2& from, const Vec2& to) const;
  // How many times as long as elsewhere a way through the cell counts.
  std::uint32_t CostOf(std::size_t cell) const { return IsClosed(cell) ? WalkGrid::kMaxCost : 1; }

 private:
  const WorldDescription& world_;
  double z_;                           // m, W
  std::vector<std::size_t> one_way_;   // in WorldDescription::zones
  std::vector<bool> closed_;           // by cell
  std::vector<std::uint8_t> against_;  // by cell: a bit for each step that is against the traffic
};

// Whether zones of the kinds that limit ways are on, by zone: other ways are to be searched once it changes.
std::vector<bool> ZonesOnWays(const WorldDescription& world, const WorldState& state);

// m, along a polyline from `here` through `points[next]` and the points behind it (W), until the body of a robot of
// that radius (m) touches a release zone that is on and comes nearer to it; at most `most`. Points are looked at every
// `step` m.
double RoomBeforeRelease(const WorldDescription& world, const WorldState& state, const Vec2& here,
                         const std::vector<Vec2>& points, std::size_t next, double z, double radius, double step,
                         double most);

}  // namespace troupe
