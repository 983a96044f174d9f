// LaneGraph: the lanes of a site, on which robots drive from vertex to vertex, and the fastest route along them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "troupe/vec2.h"

namespace troupe {

struct LaneVertex {
  std::string name;         // may be empty
  Vec2 position{0.0, 0.0};  // m, frame W
  double z = 0.0;           // m, of its floor
  bool is_charger = false;
  std::string dock;   // names: empty for none
  std::string mutex;  // a group of vertices and lanes that one robot at a time may be in
  // The lift that the vertex is in, its floor, and the doors that are open while the lift stands there.
  std::string lift;
  std::string floor;
  std::vector<std::string> lift_doors;
};

// A door that a lane passes.
struct LaneDoor {
  std::string name;
  double at = 0.0;         // m, from the start of the lane
  double clearance = 0.0;  // m, that its leaves reach to both sides
};

enum class LaneFacing : std::uint8_t { kAny, kForward, kBackward };

struct Lane {
  std::size_t start = 0;  // vertices
  std::size_t end = 0;
  bool is_bidirectional = false;
  double speed_limit = 0.0;  // m/s; 0: none
  // How the robot faces on the way from the start to the end. On the way back it keeps that heading.
  LaneFacing facing = LaneFacing::kAny;
  std::string mutex;
  std::vector<LaneDoor> doors;  // in the order of `at`
};

struct LaneGraph {
  std::vector<LaneVertex> vertices;
  std::vector<Lane> lanes;

  std::optional<std::size_t> Find(const std::string& name) const;  // the first vertex of that name
  // The first lane that leads there.
  std::optional<std::size_t> LaneBetween(std::size_t from, std::size_t to) const;
  Vec2 Way(std::size_t from, std::size_t to) const { return vertices[to].position - vertices[from].position; }
};

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

// The vertex nearest to a point, by the distance in the plane and `per_height` m for each m of height between them; of
// several the first. REQUIRES: the graph has a vertex.
std::size_t NearestVertex(const LaneGraph& graph, const Vec2& point, double z, double per_height);

// Of NearestVertex: a vertex of the level of the point, and one at exactly the point on any level before all others.
inline constexpr double kOnOneLevel = 1000.0;
inline constexpr double kOnAnyLevel = 1e-6;

}  // namespace troupe
