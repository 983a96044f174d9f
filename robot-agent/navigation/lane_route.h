// LaneRoute: the fastest way along the lanes of a site, from vertex to vertex.
//
// A plan at one time, by lengths, limits and constant costs of doors and rides: other robots are not in it. All robots
// of a site plan with the same numbers, so that their routes agree. Cost: Dijkstra's search (1959) over vertices; made
// when a target changes, not in each tick.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "troupe/site_description.h"

namespace troupe {

// A part of a route: along a lane, or with a lift, from vertex to vertex.
struct Leg {
  std::size_t from = 0;
  std::size_t to = 0;
  std::optional<std::size_t> lane = {};  // nothing: a ride in a lift, or, to the vertex `from` itself, the way there
  bool operator==(const Leg&) const = default;
};

struct LaneRoute {
  std::vector<Leg> legs;
  double seconds = 0.0;
};

// The fastest route, for a robot of that speed (m/s): by the speed limits of lanes, with a time for each door and each
// ride. Of two as fast ones it is the one whose vertices have smaller numbers, from the end. Lanes of the numbers in
// `closed` are left out. Nothing if there is none.
std::optional<LaneRoute> FastestRoute(const LaneGraph& graph, std::size_t from, std::size_t to, double speed,
                                      const std::vector<std::size_t>& closed = {});

}  // namespace troupe
