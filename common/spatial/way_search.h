// FindWay: the shortest way of a robot on a WalkGrid from where it is to a point, around bodies that stand there now.
// FindRoom: the way to where another robot can pass it.
//
// A* (Hart, Nilsson and Raphael 1968) over the steps of the grid, with the length of free steps as the estimate.
// Lengths are whole numbers, and of equally long entries the cell with the smaller number comes first, so that the way
// is the same on every machine. The cells are then joined by straight lines of free cells, in place of the steps of the
// grid.
//
// A robot plans alone and again when something is in its way, so that a search is better for it than the WalkField of
// a crowd: no memory stays, and the bodies that stand there now cost nothing to others.
#pragma once

#include <span>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "common/spatial/walk_grid.h"
#include "troupe/result.h"
#include "troupe/vec2.h"

namespace troupe {

class ZoneWays;

struct Way {
  std::vector<Vec2> points = {};  // m, W, one after another in straight lines; the last is the end
  bool reaches = true;            // false: something stands at the end, and the way leads near it
};

// The way from `from` to `to`, m, W. `standing`: pieces in W of bodies beside the static ones. `zones`: of the grid;
// null: none. The error says what prevents it: the end is not free or in a keepout zone, or no way leads there.
Result<Way> FindWay(const WalkGrid& grid, const Vec2& from, const Vec2& to,
                    std::span<const ConvexPiece* const> standing = {}, const ZoneWays* zones = nullptr);

// Checks that ways lead from `from` to each of the points, m, W, around static bodies alone. The error names the first
// point to which none does. Cost: one search, however many points there are.
Status CheckWays(const WalkGrid& grid, const Vec2& from, std::span<const Vec2> points);

// A robot that is to make room for another one.
struct RoomFor {
  double own_radius = 0.0;   // m
  Vec2 other{0.0, 0.0};      // m, W: where the other one is
  const WalkGrid& of_other;  // of the same level, for its radius
};

// The way to the nearest place at which the robot cuts nothing off from the other one: all that this can reach within
// some metres while the robot is away, it can reach past the robot there. The error: there is no such place.
Result<Way> FindRoom(const WalkGrid& grid, const Vec2& from, const RoomFor& room,
                     std::span<const ConvexPiece* const> standing, const ZoneWays* zones = nullptr);

}  // namespace troupe
