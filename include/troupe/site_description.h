// The levels of a building, the graphs of lanes on which robots drive there, zones, flows of goods and what happens at
// given times: parts of a WorldDescription.
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
  bool is_waiting_place = false;
  std::string dock;
  std::string mutex;
  std::optional<std::uint32_t> lift = {};
  std::uint32_t floor = 0;
  bool is_between = false;
  bool operator==(const LaneVertex&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &LaneVertex::name, "may be empty"},
        Field{"position", &LaneVertex::position, "in W"}.In("m"),
        Field{"z", &LaneVertex::z, "of its floor"}.In("m"),
        Field{"charger", &LaneVertex::is_charger},
        Field{"waiting_place", &LaneVertex::is_waiting_place, "a robot may wait there for a charger"},
        Field{"dock", &LaneVertex::dock, "its name; empty: none"},
        Field{"mutex", &LaneVertex::mutex, "a group of vertices and lanes for one robot at a time; empty: none"},
        Field{"lift", &LaneVertex::lift, "around the vertex, in WorldDescription::lifts"},
        Field{"floor", &LaneVertex::floor, "of the lift, in LiftDescription::floors"},
        Field{"between", &LaneVertex::is_between, "a waiting point on a lane of the site, which leads on (WholeLane)"},
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

inline constexpr double kLevelGap = 1.3;  // m: bodies and lanes so far apart in height are on different levels

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
  double DistanceTo(const Lane& lane, const Vec2& point) const;  // m, in the plane
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

enum class ZoneKind : std::uint8_t {
  kKeepout = 0,     // robots do not drive into it
  kSpeed = 1,       // they drive more slowly in it
  kCleaning = 2,    // its cells count as covered once a robot has been on them
  kOneWay = 3,      // they drive through it within 90 degrees of its heading; lanes are so from the load on, always
  kRelease = 4,     // they stop before it until it is switched off
  kEvacuation = 5,  // people in it walk to the nearest of its exits, and leave the world there
};
constexpr auto NamesOf(ZoneKind) {
  return std::array{"keepout", "speed", "cleaning", "one_way", "release", "evacuation"};
}

// An area of a level that robots on lanes, and those that search their ways, heed while it is on.
struct ZoneDescription {
  std::string name;
  ZoneKind kind = ZoneKind::kKeepout;
  std::vector<Vec2> outline;
  double z = 0.0;
  double speed_limit = 0.0;
  double heading = 0.0;
  bool is_on = true;
  std::optional<std::uint32_t> exits = {};
  bool operator==(const ZoneDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &ZoneDescription::name},
        Field{"kind", &ZoneDescription::kind},
        Field{"outline", &ZoneDescription::outline, "a simple polygon, counter-clockwise, in W"}.In("m"),
        Field{"z", &ZoneDescription::z, "of its level"}.In("m"),
        Field{"speed_limit", &ZoneDescription::speed_limit, "of a speed zone"}.In("m/s").AtLeast(0),
        Field{"heading", &ZoneDescription::heading, "of a one_way zone: the direction of its traffic, in W"}.In("rad"),
        Field{"on", &ZoneDescription::is_on, "at load"},
        Field{"exits", &ZoneDescription::exits, "of an evacuation zone: a goal set, in WorldDescription::exits"},
    };
  }
};

// Goods that come to a place at a rate, and have to be brought to another one.
struct GoodsFlow {
  std::string name;
  std::string from;
  std::string to;
  Vec2 place{0.0, 0.0};
  double z = 0.0;
  double per_hour = 0.0;
  bool is_random = true;
  std::uint32_t stock = 0;
  std::uint32_t room = 100;
  double due = 600.0;
  double load_seconds = 5.0;
  double unload_seconds = 5.0;
  std::string robots = "*";
  bool operator==(const GoodsFlow&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &GoodsFlow::name},
        Field{"from", &GoodsFlow::from, "the name of a vertex of the robots' lanes"},
        Field{"to", &GoodsFlow::to, "likewise"},
        Field{"place", &GoodsFlow::place, "of `from`, in W"}.In("m"),
        Field{"z", &GoodsFlow::z, "of `from`"}.In("m"),
        Field{"per_hour", &GoodsFlow::per_hour, "goods that arrive"}.Within(0, 36000),
        Field{"random", &GoodsFlow::is_random, "they arrive at random times, drawn by the seed; else evenly"},
        Field{"stock", &GoodsFlow::stock, "goods at load"}.Within(0, 10000),
        Field{"room", &GoodsFlow::room, "for goods at `from`; further ones are refused"}.Within(1, 10000),
        Field{"due", &GoodsFlow::due, "from the arrival of goods to their due time"}.In("s").Within(0, 1e6),
        Field{"load_seconds", &GoodsFlow::load_seconds}.In("s").Within(0, 3600),
        Field{"unload_seconds", &GoodsFlow::unload_seconds}.In("s").Within(0, 3600),
        Field{"robots", &GoodsFlow::robots, "names of robots that may bring them; `*` is any text"},
    };
  }
};

enum class TimedKind : std::uint8_t { kDoor = 0, kLift = 1, kLane = 2, kZone = 3 };
constexpr auto NamesOf(TimedKind) {
  return std::array{"door", "lift", "lane", "zone"};
}

// What happens at a time of a run, as if a tool had asked for it.
struct TimedAction {
  double at = 0.0;
  TimedKind kind = TimedKind::kDoor;
  std::uint32_t number = 0;
  double value = 0.0;
  bool operator==(const TimedAction&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"at", &TimedAction::at, "simulated"}.In("s").AtLeast(0),
        Field{"kind", &TimedAction::kind},
        Field{"number", &TimedAction::number, "of the door, lift or zone, or the lane, counted through all graphs"},
        Field{"value", &TimedAction::value,
              "the opening; the floor; the speed limit, 0: closed, negative: as described; 1: on, 0: off"},
    };
  }
};

// Vertices and lanes counted through all graphs of a world, in their order, as the traffic of robots has them.
struct GraphPlace {
  std::size_t graph = 0;
  std::size_t number = 0;  // of the vertex or lane in its graph
};
std::size_t CountVertices(std::span<const LaneGraph> graphs);
std::size_t CountLanes(std::span<const LaneGraph> graphs);
// The number of the first one of a graph.
std::size_t FirstVertexOf(std::span<const LaneGraph> graphs, const LaneGraph& graph);
std::size_t FirstLaneOf(std::span<const LaneGraph> graphs, const LaneGraph& graph);
// Nothing for a number beyond the last one; rides of lifts are counted behind the lanes.
std::optional<GraphPlace> FindVertex(std::span<const LaneGraph> graphs, std::size_t vertex);
std::optional<GraphPlace> FindLane(std::span<const LaneGraph> graphs, std::size_t lane);
// A lane of the site: from vertex to vertex, in parts if it has waiting points.
struct WholeLane {
  std::uint32_t start = 0;
  std::uint32_t end = 0;
  std::vector<std::uint32_t> parts;  // lanes of the graph, from the start on
};
// In the order of their first parts.
std::vector<WholeLane> WholeLanesOf(const LaneGraph& graph);
// The one that a lane of the graph is a part of.
WholeLane WholeLaneOf(const LaneGraph& graph, std::size_t lane);

// "dock", or "vertex 3" of one without a name; of a lane of the site "GRAPH: START - END".
std::string NameOfVertex(const LaneGraph& graph, std::size_t vertex);
std::string NameOfLane(const LaneGraph& graph, const WholeLane& lane);
std::string NameOfLane(const LaneGraph& graph, std::size_t lane);  // that it is a part of

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
