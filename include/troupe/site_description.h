// The levels of a building, and the graphs of lanes on which robots drive there: parts of a WorldDescription. They
// change no result of a step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "troupe/pose.h"
#include "troupe/vec2.h"

namespace troupe {

// All levels share x and y, and each is at its height.
struct LevelDescription {
  std::string name;
  double z = 0.0;  // m, of its floor
  bool operator==(const LevelDescription&) const = default;
};

// The name of the level nearest to a height, of two the lower one; "L1" without levels.
std::string LevelAt(std::span<const LevelDescription> levels, double z);

struct LaneVertex {
  std::string name;         // may be empty
  Vec2 position{0.0, 0.0};  // m, frame W
  double z = 0.0;           // m, of its floor
  bool is_charger = false;
  std::string dock;                        // names: empty for none
  std::string mutex;                       // a group of vertices and lanes that one robot at a time may be in
  std::optional<std::uint32_t> lift = {};  // that the vertex is in, in WorldDescription::lifts
  std::uint32_t floor = 0;                 // of the lift, in LiftDescription::floors
  bool operator==(const LaneVertex&) const = default;
};

// A door that a lane passes.
struct LaneDoor {
  std::uint32_t door = 0;  // in WorldDescription::doors
  double at = 0.0;         // m, from the start of the lane
  bool operator==(const LaneDoor&) const = default;
};

enum class LaneFacing : std::uint8_t { kAny = 0, kForward = 1, kBackward = 2 };
constexpr LaneFacing LastOf(LaneFacing) {
  return LaneFacing::kBackward;
}

struct Lane {
  std::uint32_t start = 0;  // vertices
  std::uint32_t end = 0;
  bool is_bidirectional = false;
  double speed_limit = 0.0;  // m/s; 0: none
  // How the robot faces on the way from the start to the end. On the way back it keeps that heading.
  LaneFacing facing = LaneFacing::kAny;
  std::string mutex;
  std::vector<LaneDoor> doors;  // in the order of `at`
  bool operator==(const Lane&) const = default;
};

// The lanes of one kind of robot, straight from vertex to vertex.
struct LaneGraph {
  std::uint32_t number = 0;  // by which robots name it
  std::vector<LaneVertex> vertices;
  std::vector<Lane> lanes;
  bool operator==(const LaneGraph&) const = default;

  std::optional<std::size_t> Find(const std::string& name) const;  // the first vertex of that name
  // The first lane that leads there.
  std::optional<std::size_t> LaneBetween(std::size_t from, std::size_t to) const;
  Vec2 Way(std::size_t from, std::size_t to) const { return vertices[to].position - vertices[from].position; }
};

// The vertex nearest to a point, by the distance in the plane and `per_height` m for each m of height between them; of
// several the first. Nothing if the graph has no vertex.
struct NearVertex {
  std::size_t vertex = 0;
  double distance = 0.0;
};
std::optional<NearVertex> FindNearestVertex(const LaneGraph& graph, const Vec2& point, double z, double per_height);

// Of FindNearestVertex: a vertex of the level of the point, and one at exactly the point on any level before all
// others.
inline constexpr double kOnOneLevel = 1000.0;
inline constexpr double kOnAnyLevel = 1e-6;

// The graph with the vertex nearest to a pose, on its level if there is one; of several the first. Null without graphs.
const LaneGraph* GraphAt(std::span<const LaneGraph> graphs, const Pose& X_WR);
// The graph with that number; null if there is none.
const LaneGraph* FindGraph(std::span<const LaneGraph> graphs, std::uint32_t number);

}  // namespace troupe
