#include "worldfile/load_world.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "worldfile/gazebo/gazebo_tree.h"
#include "worldfile/grids/grid_tree.h"
#include "worldfile/map/map_yaml.h"
#include "worldfile/models/build_world.h"
#include "worldfile/models/crowd.h"
#include "worldfile/models/types/model_types.h"
#include "worldfile/scenario/scenario.h"
#include "worldfile/sites/building_yaml.h"
#include "worldfile/sites/lif_json.h"
#include "worldfile/sites/route_graph.h"
#include "worldfile/sites/site.h"
#include "worldfile/sites/site_tree.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/stage/world_tree.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// Stage and Gazebo worlds, and ROS maps, with the robots of options.
Result<LoadedWorld> LoadPlainWorld(const std::string& path, const LoadOverrides& overrides) {
  const std::string ending = std::filesystem::path(path).extension().string();
  const bool is_map = ending == ".yaml" || ending == ".yml";
  Result<WorldTree> tree = is_map ? MapYamlTree(path) : ReadWorldTree(path, overrides.allowed);
  if (!tree.ok()) return tree.error();
  if (Status error = AddRobots(overrides.robots, overrides.allowed, tree.value()); !error.ok()) return error.error();
  return BuildWorld(tree.value(), overrides);
}

// The controller of the robots of a building, without one of their own: they wait for goals on its lanes.
std::optional<std::string> ControllerOf(const Site& site, const LoadOverrides& overrides) {
  const bool has_lanes =
      std::any_of(site.levels.begin(), site.levels.end(), [](const auto& level) { return !level.lanes.empty(); });
  // A plan without lanes gives its robots nothing to follow: they stay without a controller.
  return overrides.controller || !has_lanes ? overrides.controller : std::optional<std::string>("lanes");
}

Result<LoadedWorld> LoadBuilding(const std::string& path, const LoadOverrides& overrides) {
  Result<WorldTree> tree = ReadSiteTree(path, overrides.allowed);
  if (!tree.ok()) return tree.error();
  if (Status error = AddRobots(overrides.robots, overrides.allowed, tree.value()); !error.ok()) return error.error();
  LoadOverrides build = overrides;
  build.controller = ControllerOf(*tree.value().site, overrides);
  Result<LoadedWorld> built = BuildWorld(tree.value(), build);
  if (!built.ok()) return built;
  Result<LoadedWorld> crowded = AddCrowd(std::move(built).value());
  if (!crowded.ok()) return crowded;
  PrepareLanes(crowded.value(), path);
  if (Status error = CheckControllersInWorld(crowded.value(), path, overrides); !error.ok()) return error.error();
  return crowded;
}

Result<LoadedWorld> LoadGrid(const std::string& path, const LoadOverrides& overrides) {
  Result<WorldTree> tree = ReadGridTree(path, overrides.grid, overrides.allowed);
  if (!tree.ok()) return tree.error();
  if (Status error = AddRobots(overrides.robots, overrides.allowed, tree.value()); !error.ok()) return error.error();
  Result<LoadedWorld> built = BuildWorld(tree.value(), overrides);
  if (!built.ok()) return built;
  if (Status error = CheckControllersInWorld(built.value(), path, overrides); !error.ok()) return error.error();
  return built;
}

Result<LoadedWorld> LoadByEnding(const std::string& path, const LoadOverrides& overrides) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (IsGridPath(path, overrides.allowed)) return LoadGrid(path, overrides);
  if (overrides.grid != GridOptions()) {
    return Error{{path},
                 "found no problem of paths for the options about agents and paths, expected .scen, .map, "
                 ".pogema or a problem of the League (.json)"};
  }
  if (IsBuildingPath(path) || IsRouteGraphPath(path) || IsLayoutPath(path, overrides.allowed)) {
    return LoadBuilding(path, overrides);
  }
  if (ending == ".json") return LoadScenario(path, overrides);
  if (ending == ".world" || ending == ".yaml" || ending == ".yml" || IsModelFile(path)) {
    return LoadPlainWorld(path, overrides);
  }
  return Error{{path},
               "found a file ending in " + Quoted(ending) +
                   ", expected .world (Stage, Gazebo), .sdf (Gazebo), .urdf or .xacro (a robot), .json (scenario, "
                   "LIF), .yaml (ROS map) or "
                   ".building.yaml (Open-RMF), .geojson (Nav2's route server), .scen, .map or .pogema (cells)"};
}

std::string EndingOf(const std::string& path) {
  return std::filesystem::path(path).extension().string();
}

bool IsFile(const std::string& source) {
  const std::string ending = EndingOf(source);
  return ending == ".world" || ending == ".inc" || ending == ".json" || IsModelFile(source);
}

// The defines of models, and the controller of robots without one.
Result<ScenarioWorld> ReadDefinitions(const WorldSource& source, const LoadOverrides& overrides) {
  const std::string& path = source.path;
  if (source.scenario) return ReadScenarioWorldText(*source.scenario, path, overrides);
  if (EndingOf(path) == ".json" && !IsLayoutPath(path, overrides.allowed) && !IsGridPath(path, overrides.allowed))
    return ReadScenarioWorld(path, overrides);
  Result<WorldTree> tree = ReadWorldTree(path, overrides.allowed);
  if (!tree.ok()) return tree.error();
  ScenarioWorld world;
  world.tree = std::move(tree).value();
  std::optional<std::string> controller = overrides.controller;
  if (world.tree.site != nullptr) controller = ControllerOf(*world.tree.site, overrides);
  if (controller) world.controller = ControllerDescription{*controller, "{}"};
  return world;
}

// As Instantiate, but for models only.
Result<WorldNode> MakeModel(const WorldTree& tree, const std::string& name) {
  Result<WorldNode> made = Instantiate(tree, name, {});
  if (!made.ok()) return made;
  const std::string& type = made.value().type;
  if (!IsModelType(type)) return Error{{}, "found " + Quoted(name) + ", expected a model"};
  if (FindModelType(type) == nullptr) {
    return Error{{}, (type == name ? "" : Quoted(name) + ": ") + UnknownTypeMessage(type, tree.defines)};
  }
  return made;
}

Result<LoadedWorld> BuildOne(const WorldSource& source, const std::string& name, const LoadOverrides& overrides) {
  Result<ScenarioWorld> definitions = ReadDefinitions(source, overrides);
  if (!definitions.ok()) return definitions.error();
  WorldTree& tree = definitions.value().tree;
  Result<WorldNode> model = MakeModel(tree, name);
  if (!model.ok()) return model.error();
  const bool controlled = model.value().Find("ctrl") != nullptr;
  tree.world.children = {};
  tree.world.children.Add(std::move(model).value());
  LoadOverrides build = overrides;
  // The scenario's controller, with its parameters, is set below; an override has a name only.
  build.controller.reset();
  Result<LoadedWorld> loaded = BuildWorld(tree, build);
  if (!loaded.ok()) return loaded;
  const auto domains = definitions.value().ros_domains_from.find(name);
  if (domains != definitions.value().ros_domains_from.end()) loaded.value().ros_domains_from = domains->second;
  if (controlled || !definitions.value().controller) return loaded;
  for (RobotDescription& robot : loaded.value().world.robots) robot.controller = *definitions.value().controller;
  return loaded;
}

Result<LoadedWorld> LoadFile(const std::string& path, const LoadOverrides& overrides) {
  LoadOverrides alone = overrides;
  alone.robots.clear();
  return EndingOf(path) == ".inc" ? LoadPlainWorld(path, alone) : LoadWorld(path, alone);
}

}  // namespace

bool IsForeignWorld(const std::string& path) {
  const std::string ending = EndingOf(path);
  return IsGazeboPath(path) || IsBuildingPath(path) || IsRouteGraphPath(path) || IsLayoutPath(path) ||
         IsGridPath(path) || ending == ".yaml" || ending == ".yml";
}

Result<LoadedWorld> LoadWorld(const std::string& path, const LoadOverrides& overrides) {
  Result<LoadedWorld> loaded = LoadByEnding(path, overrides);
  if (loaded.ok()) AppendPlacementWarnings(path, loaded.value());
  return loaded;
}

Result<LoadedWorld> LoadWorld(const WorldSource& source, const LoadOverrides& overrides) {
  if (!source.scenario) return LoadWorld(source.path, overrides);
  Result<LoadedWorld> loaded = LoadScenarioText(*source.scenario, source.path, overrides);
  if (loaded.ok()) AppendPlacementWarnings(source.path, loaded.value());
  return loaded;
}

Result<std::vector<Spawnable>> ListSpawnables(const std::string& world_file, const LoadOverrides& overrides) {
  const Result<ScenarioWorld> definitions = ReadDefinitions({world_file}, overrides);
  if (!definitions.ok()) return definitions.error();
  const WorldTree& tree = definitions.value().tree;
  std::vector<Spawnable> found;
  for (const auto& [name, define] : tree.defines) {
    const Result<WorldNode> model = MakeModel(tree, name);
    // A define of a sensor or a light is no model by itself, and a broken one no reason to hide the others.
    if (!model.ok()) continue;
    const std::string& type = model.value().type;
    if (type == "model" || type == "position") found.push_back({name, type});  // others are parts of these
  }
  for (const char* type : {"model", "position"}) found.push_back({type, type});
  return found;
}

Result<LoadedWorld> LoadSpawnable(const WorldSource& world, const std::string& source, const LoadOverrides& overrides) {
  if (source.empty()) return Error{{}, "found nothing to spawn, expected a model or a file"};
  const std::size_t hash = source.rfind('#');
  const std::string file = source.substr(0, hash);
  if (!IsFile(file)) return BuildOne(world, source, overrides);
  if (hash != std::string::npos) return BuildOne({file}, source.substr(hash + 1), overrides);
  Result<LoadedWorld> loaded = LoadFile(file, overrides);
  if (!loaded.ok()) return loaded;
  const std::vector<ModelDescription>& models = loaded.value().world.models;
  const auto count = std::count_if(models.begin(), models.end(), [](const auto& model) { return !model.parent; });
  if (count != 1) {
    return Error{{file},
                 "found " + std::to_string(count) +
                     " models, expected one, with its parts, or FILE#NAME for a model "
                     "that the file defines"};
  }
  return loaded;
}

Status SetController(const ControllerDescription& controller, const LoadOverrides& overrides,
                     WorldDescription& spawned) {
  if (spawned.robots.empty()) {
    return BadInput("found a controller for a model that is no robot, expected one for robots only");
  }
  if (overrides.check_controller) {
    if (Status status = overrides.check_controller(controller.name, controller.parameters); !status.ok()) return status;
  }
  for (RobotDescription& robot : spawned.robots) robot.controller = controller;
  return {};
}

}  // namespace troupe
