// Brings what a scenario adds and changes into the tree of its world.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/worldfile/scenario_file.h"
#include "common/worldfile/world_tree.h"

namespace troupe {

// The models that one spawn rule added, still without a place.
struct PlannedSpawn {
  const SpawnEntry* rule = nullptr;
  std::vector<std::string> names;
  bool origin_at_start = true;  // odometry counts from where the robot starts: the world says nothing else
};

// What the tree cannot say.
struct ScenarioPlan {
  std::vector<PlannedSpawn> spawns;
  std::map<std::string, ControllerDescription> controllers;  // by robot
};

// Adds the models, robots and spawned models of `file` to `tree`, and applies its overrides. `default_controller` goes
// to the robots for which neither world nor scenario names one. The plan refers to `file`.
Result<ScenarioPlan> ApplyScenario(const ScenarioFile& file,
                                   const std::optional<ControllerDescription>& default_controller, WorldTree* tree);

// Adds an included file's defines and models. The first define of a name counts.
void MergeInclude(WorldTree include, const SourceLocation& where, WorldTree* tree);

}  // namespace troupe
