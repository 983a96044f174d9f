// Site: a building as its plan describes it, in metres, in frame W. All levels share x and y; a level's z is its
// elevation, so that a lift moves along z only.
//
// A neutral form between the readers (building_yaml.h, lif_json.h) and the users: the models of the world
// (site_tree.h), the lanes for robots (worldfile/models/lanes.h), the crowd (people.h) and the writers
// (building_text.h, lif_json.h). It keeps the numbers of vertices of the file, to which edges refer, and parts without
// effect, so that an export does not lose them. A world shares it as a constant.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "troupe/polygon.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "troupe/vec2.h"
#include "worldfile/stage/part_draft.h"

namespace troupe {

// A corner of walls and floors, or a waypoint of lanes.
struct SiteVertex {
  Vec2 position{0.0, 0.0};
  std::string name;  // may be empty
  bool is_charger = false;
  bool is_parking_spot = false;
  bool is_holding_point = false;
  bool is_cleaning_zone = false;
  bool is_passthrough_point = false;
  std::string dock;        // names: empty for none
  std::string lift_cabin;  // the lift that the vertex is in
  std::string pickup_dispenser;
  std::string dropoff_ingestor;
  std::string mutex;
  std::string human_goal_set;
  std::string robot_type;  // of the robot that starts here
  std::string robot_name;
  SourceLocation where;
};

// Vertices of a level, by number.
struct SiteEdge {
  std::size_t start = 0;
  std::size_t end = 0;
  SourceLocation where;
};

struct SiteDoor {
  SiteEdge edge;
  std::string name;
  DoorKind kind = DoorKind::kHinged;
  double swing = 1.5707963267948966;  // rad, of hinged ones
  bool opens_clockwise = true;        // a single leaf about its hinge; of two the leaf at the start
  bool hinge_at_end = false;          // of a single leaf: it turns about the end, or slides towards it
  double right_left_ratio = 1.0;      // widths of the leaves at the start and at the end
  bool is_operated = true;            // false: nothing moves it
};

// A model that puts items onto robots, or takes them from there.
struct SiteWorkcell {
  std::string name;
  bool dispenses = true;  // false: an ingestor
  Vec2 position{0.0, 0.0};
  double height = 0.0;  // m above the level
  SourceLocation where;
};

struct SiteFloor {
  std::vector<std::size_t> vertices;
  SourceLocation where;
};

struct SiteLane {
  SiteEdge edge;
  std::uint32_t graph = 0;
  bool is_bidirectional = false;
  std::string orientation;   // "forward", "backward" or empty
  double speed_limit = 0.0;  // m/s; 0: none
  std::string mutex;
};

// Where people walk.
struct SiteHumanLane {
  SiteEdge edge;
  std::uint32_t graph = 0;
  double width = 0.0;  // m
};

struct SiteLevel {
  std::string name;
  double elevation = 0.0;  // m
  std::string drawing;     // file name; empty for none
  double scale = 1.0;      // m for a unit of the file: a pixel of the drawing, or a metre
  Pose X_WF;               // of the drawing's upper left corner, with x to its right
  std::size_t measurements = 0;
  std::vector<SiteVertex> vertices;
  std::vector<SiteEdge> walls;
  std::vector<SiteDoor> doors;
  std::vector<SiteFloor> floors;
  std::vector<SiteLane> lanes;
  std::vector<SiteWorkcell> workcells;
  std::vector<SiteHumanLane> human_lanes;
  SourceLocation where;
};

// A door in the frame C of a lift's cabin, whose origin is the middle of its floor.
struct SiteLiftDoor {
  std::string name;
  Vec2 position{0.0, 0.0};  // m
  double heading = 0.0;     // rad, along which its leaves slide
  double width = 0.0;       // m
};

struct SiteLift {
  std::string name;
  Pose X_WC;           // at the initial level
  double width = 0.0;  // m, along x of frame C
  double depth = 0.0;  // m, along y
  std::size_t initial_level = 0;
  std::vector<SiteLiftDoor> doors;
  // By level: the numbers of the doors that open there; none for a level where it does not stop.
  std::vector<std::vector<std::size_t>> doors_at;
  bool is_operated = true;
  SourceLocation where;
};

// People, as crowd_sim describes them.
struct CrowdProfile {
  std::string name;
  double radius = 0.0;         // m
  double speed = 0.0;          // m/s, preferred
  double max_speed = 0.0;      // m/s
  double neighbor_dist = 0.0;  // m
  std::size_t max_neighbors = 0;
  double horizon = 0.0;            // s, for collisions with others
  double horizon_obstacles = 0.0;  // s, with walls
};
struct CrowdGroup {
  std::size_t count = 0;
  std::vector<std::string> robots;  // that the group stands for; empty: people
  std::string profile;
  std::string state;
  Vec2 start{0.0, 0.0};  // m, frame W
  SourceLocation where;
};
struct CrowdState {
  std::string name;
  std::int64_t goal_set = -1;  // -1: stands
  bool is_final = false;
  SourceLocation where;
};
struct CrowdGoalSet {
  std::int64_t id = 0;
  std::size_t capacity = 0;
  std::vector<std::string> areas;  // of vertices' human_goal_set
  SourceLocation where;
};
struct CrowdChoice {
  std::string state;
  double weight = 1.0;
};
struct CrowdTransition {
  std::string from;
  std::vector<CrowdChoice> to;
  double distance = 0.0;  // m, at which a goal is reached
  double wait = 0.0;      // s
};
struct SiteCrowd {
  bool is_enabled = false;
  double interval = 0.1;  // s
  std::vector<CrowdProfile> profiles;
  std::vector<CrowdGroup> groups;
  std::vector<CrowdState> states;
  std::vector<CrowdGoalSet> goal_sets;
  std::vector<CrowdTransition> transitions;

  std::size_t people() const {
    std::size_t count = 0;
    for (const CrowdGroup& group : groups) count += group.robots.empty() ? group.count : 0;
    return count;
  }
};

struct Site {
  std::string name;
  std::string file;
  std::vector<SiteLevel> levels;  // in the order of the file
  std::vector<SiteLift> lifts;
  SiteCrowd crowd;
  std::size_t furniture = 0;  // models, whose shapes the file does not have
  std::vector<Warning> warnings;
};

}  // namespace troupe
