#include "common/worldfile/scenario.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/worldfile/json_document.h"
#include "common/worldfile/map_yaml.h"
#include "common/worldfile/place_spawns.h"
#include "common/worldfile/quote.h"
#include "common/worldfile/scenario_file.h"
#include "common/worldfile/scenario_tree.h"
#include "common/worldfile/stage_parser.h"
#include "common/worldfile/text_file.h"

namespace troupe {
namespace {

std::string FolderOf(const std::string& path) {
  return std::filesystem::path(path).parent_path().string();
}

// Reads a file that the scenario names. If it cannot be opened at all, the scenario's line is to blame.
Result<WorldTree> ReadNamed(const PlacedText& name, const std::string& directory, const ScenarioTools& tools) {
  Result<WorldTree> tree = tools.read_world((std::filesystem::path(directory) / name.text).lexically_normal().string());
  if (!tree.ok() && tree.error().where.line == 0) return Error{name.where, tree.error().message};
  return tree;
}

Result<WorldTree> ReadTree(const ScenarioFile& file, const std::string& path, const ScenarioTools& tools) {
  const std::string directory = FolderOf(path);
  Result<WorldTree> tree = file.world ? ReadNamed(*file.world, directory, tools) : ParseStageText("", path);
  if (!tree.ok()) return tree;
  if (file.world) tree.value().files.insert(tree.value().files.begin(), path);
  for (const PlacedText& include : file.includes) {
    Result<WorldTree> included = ReadNamed(include, directory, tools);
    if (!included.ok()) return included;
    MergeInclude(std::move(included).value(), include.where, &tree.value());
  }
  return tree;
}

// Asks `check` about every controller that the scenario names.
Status CheckControllers(const ScenarioFile& file, const LoadOverrides& overrides) {
  if (!overrides.check_controller) return std::nullopt;
  const auto check = [&](const std::optional<ControllerEntry>& entry) -> Status {
    if (!entry) return std::nullopt;
    std::string fault = overrides.check_controller(entry->controller.name, entry->controller.parameters);
    if (fault.empty()) return std::nullopt;
    return Error{entry->where, std::move(fault)};
  };
  if (Status error = check(file.controller)) return error;
  for (const ModelEntry& robot : file.robots) {
    if (Status error = check(robot.controller)) return error;
  }
  for (const SpawnEntry& spawn : file.spawns) {
    if (Status error = check(spawn.controller)) return error;
  }
  return std::nullopt;
}

// Reads and checks what can be checked without the scenario's world.
Result<ScenarioFile> ReadText(const std::string& text, const std::string& path, const LoadOverrides& overrides,
                              const ScenarioTools& tools) {
  const Result<JsonDocument> document = JsonDocument::Parse(text, path);
  if (!document.ok()) return document.error();
  if (Status error = tools.schema.Check(document.value())) return *error;
  Result<ScenarioFile> file = ReadScenarioFile(document.value(), FolderOf(path), tools.max_spawned);
  if (!file.ok()) return file;
  if (Status error = CheckControllers(file.value(), overrides)) return *error;
  return file;
}

std::optional<ControllerDescription> DefaultController(const ScenarioFile& file, const LoadOverrides& overrides) {
  if (overrides.controller) return ControllerDescription{*overrides.controller, "{}"};
  if (file.controller) return file.controller->controller;
  return std::nullopt;
}

}  // namespace

Result<WorldTree> ReadWorldTree(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending != ".yaml" && ending != ".yml") return ParseStageWorld(path);
  // The tree only names the map: whether it can be read would show too late to blame the right line.
  const Result<MapYaml> map = ReadMapYaml(path, {path});
  if (!map.ok()) return map.error();
  return MapYamlTree(path);
}

Result<LoadedWorld> LoadScenario(const std::string& path, const LoadOverrides& overrides) {
  const Result<std::string> text = ReadTextFile(path, {path, 0, 0});
  if (!text.ok()) return text.error();
  return LoadScenarioText(text.value(), path, overrides);
}

Status CheckScenario(const std::string& path, const LoadOverrides& overrides) {
  const Result<std::string> text = ReadTextFile(path, {path, 0, 0});
  if (!text.ok()) return text.error();
  const Result<ScenarioFile> file = ReadText(text.value(), path, overrides, ScenarioTools{});
  if (!file.ok()) return file.error();
  return std::nullopt;
}

Result<ScenarioWorld> ReadScenarioWorld(const std::string& path, const LoadOverrides& overrides) {
  const ScenarioTools tools;
  const Result<std::string> text = ReadTextFile(path, {path, 0, 0});
  if (!text.ok()) return text.error();
  const Result<ScenarioFile> file = ReadText(text.value(), path, overrides, tools);
  if (!file.ok()) return file.error();
  Result<WorldTree> tree = ReadTree(file.value(), path, tools);
  if (!tree.ok()) return tree.error();
  for (const Property& property : file.value().properties) tree.value().world.Set(property);
  return ScenarioWorld{std::move(tree).value(), DefaultController(file.value(), overrides)};
}

Result<HostsOfScenario> ReadHostsOfScenario(const std::string& path) {
  const Result<std::string> text = ReadTextFile(path, {path, 0, 0});
  if (!text.ok()) return text.error();
  Result<ScenarioFile> file = ReadText(text.value(), path, {}, ScenarioTools{});
  if (!file.ok()) return file.error();
  return std::move(file.value().hosts);
}

Result<LoadedWorld> LoadScenarioText(const std::string& text, const std::string& path, const LoadOverrides& overrides,
                                     const ScenarioTools& tools) {
  const Result<ScenarioFile> read = ReadText(text, path, overrides, tools);
  if (!read.ok()) return read.error();
  const ScenarioFile& file = read.value();

  Result<WorldTree> tree = ReadTree(file, path, tools);
  if (!tree.ok()) return tree.error();
  const Result<ScenarioPlan> plan = ApplyScenario(file, DefaultController(file, overrides), &tree.value());
  if (!plan.ok()) return plan.error();
  LoadOverrides build;
  build.seed = overrides.seed ? overrides.seed : file.seed;
  Result<LoadedWorld> loaded = BuildWorld(tree.value(), build, tools.build);
  if (!loaded.ok()) return loaded;

  LoadedWorld& result = loaded.value();
  const std::optional<std::uint64_t> ticks_of_world = result.settings.ticks;  // its quit_time
  result.settings = file.settings;
  if (!result.settings.ticks) result.settings.ticks = ticks_of_world;
  if (file.name) result.world.name = *file.name;
  for (RobotDescription& robot : result.world.robots) {
    const auto controller = plan.value().controllers.find(robot.name);
    if (controller != plan.value().controllers.end()) robot.controller = controller->second;
  }
  if (Status error = PlaceSpawns(plan.value().spawns, result.world.seed, &result, tools.max_spawn_draws)) return *error;
  result.warnings.insert(result.warnings.begin(), file.warnings.begin(), file.warnings.end());
  return loaded;
}

}  // namespace troupe
