// JSON scenarios: a world, additions and changes to it, and the settings of its run. docs/scenarios.md describes the
// format; configs/scenario.schema.json is its schema.
//
// The steps of a load, each with its own errors: the text (json_tree.h), its form by the schema (scenario_schema.h),
// its entries (scenario_file.h), the tree of its world with its includes, the entries merged into the tree
// (scenario_tree.h), the built world (worldfile/models/build_world.h), and what needs built geometry: places of spawned
// models, crowds, people, controllers. The first error ends the load.
//
// Everything is deterministic: equal files and an equal seed give equal worlds, on every machine. Errors of controllers
// are reported at their entry. Any thread may call the functions.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "common/run/run_settings.h"
#include "troupe/result.h"
#include "worldfile/models/build_world.h"
#include "worldfile/scenario/place_spawns.h"
#include "worldfile/scenario/scenario_file.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// Loads a scenario and the files that it names. Paths in a scenario start at its own folder.
Result<LoadedWorld> LoadScenario(const std::string& path, const LoadOverrides& overrides = {});

// The checks that do not need the world that the scenario names: its form, and its controllers by
// `overrides.check_controller`.
Status CheckScenario(const std::string& path, const LoadOverrides& overrides);

// The world that a scenario names, without the scenario's additions, and what it says of models that are added later.
struct ScenarioWorld {
  WorldTree tree;
  std::optional<ControllerDescription> controller;        // of robots without one
  std::map<std::string, std::uint32_t> ros_domains_from;  // first of the ROS domains of a spawn rule, by its model
};
Result<ScenarioWorld> ReadScenarioWorld(const std::string& path, const LoadOverrides& overrides = {});
// The same from text, as LoadScenarioText.
Result<ScenarioWorld> ReadScenarioWorldText(const std::string& text, const std::string& path,
                                            const LoadOverrides& overrides = {});

// The tree of the world that a scenario makes, with its own models and robots, and with the spawned ones, which have no
// place yet. `path` names the text in messages; relative paths start at its folder.
Result<WorldTree> ReadScenarioTree(const std::string& text, const std::string& path,
                                   const LoadOverrides& overrides = {});

// The machines that a scenario names.
Result<HostsOfScenario> ReadHostsOfScenario(const std::string& path);

// The tree of a Stage world or include file, or (by its ending) of a ROS map or a building.
Result<WorldTree> ReadWorldTree(const std::string& path, const AllowedPaths& allowed = AllowedPaths::All());

// The means of loading a scenario, for callers that load many or must not touch the disk.
struct ScenarioTools {
  // Reads the files that "world" and "include" name.
  std::function<Result<WorldTree>(const std::string& path, const AllowedPaths& allowed)> read_world = ReadWorldTree;
  BuildOptions build;
  std::uint32_t max_spawned = kMaxSpawned;
  std::uint64_t max_spawn_draws = kMaxSpawnDraws;
};

// The same from text: `path` names it in messages; relative paths start at its folder.
Result<LoadedWorld> LoadScenarioText(const std::string& text, const std::string& path,
                                     const LoadOverrides& overrides = {}, const ScenarioTools& tools = {});

// The override rules of a scenario.

// The world with the rule's properties in every node that it matches, at any depth: models by name, models and sensors
// by their type or a define that they were made from. A rule without a match is an error that lists names and types.
Result<WorldNode> ApplyOverride(const OverrideEntry& rule, WorldNode world);

}  // namespace troupe
