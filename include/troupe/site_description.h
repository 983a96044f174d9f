// The levels of a building, and the graphs of lanes on which robots drive there: parts of a WorldDescription. They
// change no result of a step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "troupe/enum_names.h"
#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/vec2.h"

namespace troupe {

// All levels share x and y, and each is at its height.
struct LevelDescription {
  std::string name;
  double z = 0.0;
  bool operator==(const LevelDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &LevelDescription::name},
        Field{"z", &LevelDescription::z, "of its floor"}.In("m"),
    };
  }
};

// The name of the level nearest to a height, of two the lower one; "L1" without levels.
std::string LevelAt(std::span<const LevelDescription> levels, double z);

struct LaneVertex {
  std::string name;
  Vec2 position{0.0, 0.0};
  double z = 0.0;
  bool is_charger = false;
  std::string dock;
  std::string mutex;
  std::optional<std::uint32_t> lift = {};
  std::uint32_t floor = 0;
  bool operator==(const LaneVertex&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &LaneVertex::name, "may be empty"},
        Field{"position", &LaneVertex::position, "in W"}.In("m"),
        Field{"z", &LaneVertex::z, "of its floor"}.In("m"),
        Field{"charger", &LaneVertex::is_charger},
        Field{"dock", &LaneVertex::dock, "its name; empty: none"},
        Field{"mutex", &LaneVertex::mutex, "a group of vertices and lanes for one robot at a time; empty: none"},
        Field{"lift", &LaneVertex::lift, "around the vertex, in WorldDescription::lifts"},
        Field{"floor", &LaneVertex::floor, "of the lift, in LiftDescription::floors"},
    };
  }
};

// A door that a lane passes.
struct LaneDoor {
  std::uint32_t door = 0;
  double at = 0.0;
  bool operator==(const LaneDoor&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"door", &LaneDoor::door, "in WorldDescription::doors"},
        Field{"at", &LaneDoor::at, "distance from the start of the lane"}.In("m").AtLeast(0),
    };
  }
};

// Half the width of a lane: a body is on it whose origin is within that distance of its line, on its level.
inline constexpr double kLaneHalfWidth = 0.5;  // m

enum class LaneFacing : std::uint8_t { kAny = 0, kForward = 1, kBackward = 2 };
constexpr auto NamesOf(LaneFacing) {
  return std::array{"any", "forward", "backward"};
}

struct Lane {
  std::uint32_t start = 0;
  std::uint32_t end = 0;
  bool is_bidirectional = false;
  double speed_limit = 0.0;
  LaneFacing facing = LaneFacing::kAny;
  std::string mutex;
  std::vector<LaneDoor> doors;
  bool operator==(const Lane&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"start", &Lane::start, "vertex"},
        Field{"end", &Lane::end, "vertex"},
        Field{"bidirectional", &Lane::is_bidirectional},
        Field{"speed_limit", &Lane::speed_limit, "0: none"}.In("m/s").AtLeast(0),
        Field{"facing", &Lane::facing, "of the robot from the start to the end; on the way back it keeps that heading"},
        Field{"mutex", &Lane::mutex, "as of vertices"},
        Field{"doors", &Lane::doors, "in the order of `at`"},
    };
  }
};

// The lanes of one kind of robot, straight from vertex to vertex.
struct LaneGraph {
  std::uint32_t number = 0;
  std::vector<LaneVertex> vertices;
  std::vector<Lane> lanes;
  bool operator==(const LaneGraph&) const = default;

  std::optional<std::size_t> Find(const std::string& name) const;  // the first vertex of that name
  // The first lane that leads there.
  std::optional<std::size_t> LaneBetween(std::size_t from, std::size_t to) const;
  Vec2 Way(std::size_t from, std::size_t to) const { return vertices[to].position - vertices[from].position; }
  static constexpr auto Fields() {
    return std::tuple{
        Field{"number", &LaneGraph::number, "by which robots name it"},
        Field{"vertices", &LaneGraph::vertices},
        Field{"lanes", &LaneGraph::lanes},
    };
  }
};

// What a robot of a problem of multi-agent paths has to do, and its path, if one is given: vertices one after another,
// each by a step of the plan. Vertices are counted through all graphs of the world, in their order.
struct LaneTrip {
  RobotId robot;
  std::vector<std::uint32_t> goals;
  std::vector<std::uint32_t> path;
  std::vector<std::uint32_t> steps;
  bool operator==(const LaneTrip&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"robot", &LaneTrip::robot},
        Field{"goals", &LaneTrip::goals, "vertices that are to be visited in this order; it stays at the last one"},
        Field{"path", &LaneTrip::path, "vertices along lanes, its start first; none: planned traffic finds it"},
        Field{"steps", &LaneTrip::steps, "of the plan, at which it is at each vertex of the path; ascending from 0"},
    };
  }
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
