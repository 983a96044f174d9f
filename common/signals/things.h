// Things: the rows of the tables of a state and its world, as users know them: their kinds, names and numbers.
//
// The kind of a thing is the table that it is a row of, by its place in StateTables(). All things of a world are
// numbered: robots, objects and people first, by which they have the numbers of their bodies (BodyId), then the other
// kinds in the order of the tables. Radio messages come and go, so that they are no things.
//
// Names of things are what users write; ids stay inside. A removed thing keeps its number and its name, and does not
// exist any more.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/world_description.h"

namespace troupe {

using ThingId = std::uint32_t;

// A lane of the site.
struct LaneRow {
  std::size_t graph = 0;  // in WorldDescription::lane_graphs
  std::size_t first = 0;  // the number of the first lane of the graph, through all graphs
  WholeLane lane = {};
};
// The lanes of the site of all graphs and the sensors of all robots, in the orders of their tables.
std::vector<LaneRow> FindLanes(const WorldDescription& world);
std::vector<SensorPlace> FindSensors(const WorldDescription& world);

class Things {
 public:
  explicit Things(const WorldDescription& world);  // valid

  std::size_t size() const { return names_.size(); }
  std::size_t count(std::size_t kind) const { return ranges_[kind].count; }
  ThingId first(std::size_t kind) const { return ranges_[kind].first; }
  std::size_t kind_of(ThingId thing) const;
  std::size_t row_of(ThingId thing) const { return thing - first(kind_of(thing)); }

  // The name of the model of a robot, object, person, door, lift, light or store; "ROBOT.PART" of a joint, gripper,
  // camera, inertial measurement unit or other sensor; the own name of a level, zone or flow; "GRAPH: START - END" of a
  // lane; "KIND NUMBER" of any other thing.
  const std::string& name(ThingId thing) const { return names_[thing]; }
  const std::vector<std::string>& names() const { return names_; }
  // The model that the thing is or is mounted on; nothing if it has none.
  std::optional<ModelId> model(ThingId thing) const { return models_[thing]; }
  // The robot that the thing is a part of.
  std::optional<RobotId> robot(ThingId thing) const { return robots_[thing]; }
  bool exists(ThingId thing) const { return exists_[thing]; }  // false: its model was removed
  // The first one of that name and kind that exists.
  std::optional<ThingId> Find(std::string_view name, std::size_t kind) const;

  // The stores of energy of a robot that can become empty: rows of WorldState::stores.
  const std::vector<std::size_t>& stores_of(RobotId robot) const { return stores_[robot.index()]; }
  // The cells of a zone that is to be cleaned; 0 of another one.
  std::size_t cells_of(std::size_t zone) const { return cells_[zone]; }
  // Of the rows of the tables of sensors and lanes.
  const std::vector<SensorPlace>& sensors() const { return sensors_; }
  const std::vector<LaneRow>& lanes() const { return lanes_; }

 private:
  struct Range {
    ThingId first = 0;
    std::uint32_t count = 0;
  };

  void FindStoresOfRobots(const WorldDescription& world);

  std::vector<Range> ranges_;       // by kind
  std::vector<std::string> names_;  // by ThingId, like the next three
  std::vector<std::optional<ModelId>> models_;
  std::vector<std::optional<RobotId>> robots_;
  std::vector<bool> exists_;
  std::vector<std::vector<std::size_t>> stores_;  // by RobotId
  std::vector<std::size_t> cells_;                // by zone
  std::vector<SensorPlace> sensors_;
  std::vector<LaneRow> lanes_;
};

}  // namespace troupe
