// The key "people" of a scenario: crowds of persons with a region, goals and ways.
//
// Two steps, because a goal may be the name of a place of the world: entries are read with the scenario, and become
// rules (worldfile/models/people.h) when the world is built. Persons are no models: they are drawn from the world's
// seed after all spawned models have their place, so that a change of the people does not move a robot.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/base/json_tree.h"
#include "troupe/result.h"
#include "worldfile/models/people.h"

namespace troupe {

// An entry, whose goals may be named places that the world has.
struct PeopleEntry {
  struct PlacedGoal {
    Vec2 point;      // m, frame W
    double z = 0.0;  // m, of its level
  };
  struct Goal {
    std::variant<PlacedGoal, std::string> place;  // or its name
    SourceLocation where;
  };

  // Of people who come and go.
  struct Visits {
    VisitorFlow flow;
    std::vector<Goal> exits;
    std::optional<std::uint32_t> stops;  // goals of a visit; nothing: all in turn, or one
  };

  PeopleRule rule;           // without its goal set
  std::vector<Goal> goals;   // none: the people stand
  bool in_turn = false;      // they are visited in their order; else drawn
  Interval wait{2.0, 10.0};  // s, at each
  std::optional<Visits> visits = {};
};

// An entry of the key "recorded_people", whose file is not read yet.
struct RecordedEntry {
  std::string file;  // as written
  SourceLocation file_where;
  double rate = 25.0;  // frames a second
  double start = 0.0;  // s
  Pose pose;           // m, rad: of the recording's frame in W
  RecordedPeople people;
};

// Goals under a key of an object; those without a height are on the floor. REQUIRES: as the schema describes it
std::vector<PeopleEntry::Goal> ReadGoals(const JsonTree& tree, const JsonNode& object, const char* key, double floor);

// Goals as a set without a name, a time to wait, or successors. The error is an unknown place.
Result<GoalSet> PlacesOf(const WorldDescription& world, const std::vector<PeopleEntry::Goal>& goals);

// The area of a region: [xmin, ymin, xmax, ymax], or a polygon of corners [x, y]. REQUIRES: as the schema describes it
Result<Polygon> ReadRegion(const JsonTree& tree, const JsonNode& region);

// The entries of `root`; none without the key. REQUIRES: the tree is valid by the schema.
Result<std::vector<PeopleEntry>> ReadPeopleEntries(const JsonTree& tree, const JsonNode& root);

std::vector<RecordedEntry> ReadRecordedEntries(const JsonTree& tree, const JsonNode& root);

// The world with these people.
Result<LoadedWorld> AddPeople(LoadedWorld loaded, const std::vector<PeopleEntry>& entries);

// The world with the people of recordings. `path`: of the scenario, beside which files are looked for.
Result<LoadedWorld> AddRecordedPeople(LoadedWorld loaded, const std::vector<RecordedEntry>& entries,
                                      const std::string& path, const AllowedPaths& allowed);

}  // namespace troupe
