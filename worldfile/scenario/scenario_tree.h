// Merges a scenario's entries into the tree of its world.
//
// The order is fixed and documented: properties of the world, models, robots, spawned models, overrides, the default
// controller. Overrides come after all models, so that they match spawned ones too; the default controller comes last,
// so that it only fills gaps. Names are unique among top-level models; a spawn rule without a prefix takes free numbers
// behind the name of its model.
//
// What a tree cannot express (controllers with JSON parameters, ROS domains, the names of the lockstep, planned places)
// is beside it in the plan, by the name of the robot.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "troupe/result.h"
#include "worldfile/scenario/scenario_file.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// The models that one spawn rule added, still without a place.
struct PlannedSpawn {
  const SpawnEntry* rule = nullptr;
  std::vector<std::string> names;
  bool origin_at_start = true;  // odometry counts from the robot's start: the world has no `localization_origin`
};

// The tree of a scenario's world, and the facts that a tree has no place for.
struct ScenarioPlan {
  WorldTree tree;
  std::vector<PlannedSpawn> spawns;
  std::map<std::string, ControllerDescription> controllers;  // by robot
  std::map<std::string, std::uint32_t> ros_domains;          // of their own, by robot
  std::vector<RosLockstepName> ros_lockstep;                 // of robots
};

// Adds the models, robots and spawned models of `file` to `tree`, and applies its overrides. `default_controller` is
// for the robots for which neither world nor scenario names one. The plan refers to `file`, which must outlive it.
Result<ScenarioPlan> ApplyScenario(const ScenarioFile& file,
                                   const std::optional<ControllerDescription>& default_controller, WorldTree tree);

// `tree` with an included file's defines and models. The first define of a name counts. `where` names the file.
WorldTree Merged(WorldTree tree, WorldTree include, const SourceLocation& where);

}  // namespace troupe
