// JSON scenarios: a world, what to add to it, what to change in it, and how to run it. docs/scenarios.md describes the
// format; configs/scenario.schema.json is its schema.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/worldfile/build_world.h"
#include "common/worldfile/host_settings.h"
#include "common/worldfile/load_world.h"
#include "common/worldfile/place_spawns.h"
#include "common/worldfile/scenario_file.h"
#include "common/worldfile/scenario_schema.h"
#include "common/worldfile/world_tree.h"

namespace troupe {

// Loads a scenario and the files that it names. Paths in a scenario start at its own folder.
Result<LoadedWorld> LoadScenario(const std::string& path, const LoadOverrides& overrides = {});

// Checks what can be checked without reading the world that the scenario names: its form, and its controllers by
// `overrides.check_controller`.
Status CheckScenario(const std::string& path, const LoadOverrides& overrides);

// The world that a scenario names, without what the scenario adds to it, and the controller of robots that have none.
struct ScenarioWorld {
  WorldTree tree;
  std::optional<ControllerDescription> controller;
};
Result<ScenarioWorld> ReadScenarioWorld(const std::string& path, const LoadOverrides& overrides = {});

// The machines that a scenario names.
Result<HostsOfScenario> ReadHostsOfScenario(const std::string& path);

// The tree of a Stage world or include file, or (by its ending) of a ROS map.
Result<WorldTree> ReadWorldTree(const std::string& path);

// What loading a scenario needs, for callers that load many or must not touch the disk.
struct ScenarioTools {
  ScenarioSchema schema;
  // Reads the files that "world" and "include" name.
  std::function<Result<WorldTree>(const std::string& path)> read_world = ReadWorldTree;
  BuildOptions build;
  std::uint32_t max_spawned = kMaxSpawned;
  std::uint64_t max_spawn_draws = kMaxSpawnDraws;
};

// The same from text: `path` names it in messages and says where relative paths start.
Result<LoadedWorld> LoadScenarioText(const std::string& text, const std::string& path,
                                     const LoadOverrides& overrides = {}, const ScenarioTools& tools = {});

}  // namespace troupe
