// The content of a scenario, read and checked by itself, before its world is loaded.
//
// Plain values with places: each entry keeps the place of its text, because most faults (a name that the world lacks, a
// region without room) are found much later. Angles are in degrees in the text and in radians here; lengths are metres
// whatever the units of the world file. Missing keys are nothing (optional), so that the defaults of the world or of
// the run stay in one place.
//
// REQUIRES of the reader that the schema has been checked: it reads members of known kinds without tests.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/json_tree.h"
#include "common/run/ros_lockstep.h"
#include "common/run/run_settings.h"
#include "troupe/polygon.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "worldfile/models/build_world.h"
#include "worldfile/scenario/people_entries.h"
#include "worldfile/scenario/site_entries.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// A text and its place in the scenario.
struct PlacedText {
  std::string text;
  SourceLocation where;
};

struct ControllerEntry {
  ControllerDescription controller;
  SourceLocation where;
};

struct PoseEntry {
  Pose pose;           // m, rad; frame: the parent's
  bool has_z = false;  // z is given
  SourceLocation where;
};

// "ros_domain": of one robot, or with "each" of the first robot of a rule, the others following.
struct RosDomainEntry {
  std::uint32_t first = 0;
  bool each = false;
  SourceLocation where;
};

// An entry of "models" or "robots", or a child of one.
struct ModelEntry {
  std::optional<PlacedText> name;
  std::optional<PlacedText> model;  // nothing: the robot of that name is in the world already
  std::optional<PoseEntry> pose;
  std::optional<ControllerEntry> controller;
  std::optional<RosDomainEntry> ros_domain;
  std::vector<std::string> ros_lockstep;  // of a robot
  std::vector<Property> properties;
  std::vector<ModelEntry> children;
  SourceLocation where;
};

struct SpawnEntry {
  PlacedText model;
  std::uint32_t count = 0;
  Polygon region;                         // normalized, m, frame W; contains the origins of the models
  std::optional<double> z;                // m, of the floor; nothing: the define's
  double spacing = 0.0;                   // m between the origins of any two models of this rule
  std::optional<std::uint64_t> seed;      // nothing: from the scenario's
  std::optional<PlacedText> name_prefix;  // nothing: the model's name
  std::optional<double> heading;          // rad; nothing: random
  std::optional<ControllerEntry> controller;
  std::optional<RosDomainEntry> ros_domain;
  std::vector<std::string> ros_lockstep;  // of each robot
  SourceLocation where;
};

struct OverrideEntry {
  std::optional<std::string> name;  // glob
  std::optional<std::string> type;  // glob over base types and defines
  std::vector<Property> properties;
  SourceLocation where;  // of "match"
};

struct ScenarioFile {
  std::optional<std::string> name;
  std::optional<PlacedText> world;
  std::vector<PlacedText> includes;
  std::optional<std::uint64_t> seed;
  RunSettings settings;
  RosLockstep ros_lockstep;
  HostsOfScenario hosts;
  std::optional<ControllerEntry> controller;
  std::vector<Property> properties;  // of the world
  std::vector<ModelEntry> models;
  std::vector<ModelEntry> robots;
  std::vector<SpawnEntry> spawns;
  std::vector<OverrideEntry> overrides;
  std::vector<NamedPlace> places;
  std::vector<NamedRegion> regions;
  std::vector<NamedExpectation> expectations;
  std::vector<PeopleEntry> people;
  std::vector<RecordedEntry> recorded_people;
  SiteEntries site;
  std::vector<PlacedText> without;  // robots and models that are left out, after all are placed
  std::vector<Warning> warnings;
};

// The most robots of all rules together: a typing error must not fill the memory.
inline constexpr std::uint32_t kMaxSpawned = 20'000;

// REQUIRES: the tree is valid by the schema. `directory` is where relative paths of bitmaps and controller
// libraries start.
Result<ScenarioFile> ReadScenarioFile(const JsonTree& tree, const std::string& directory,
                                      std::uint32_t max_spawned = kMaxSpawned);

}  // namespace troupe
