#include "worldfile/scenario/scenario.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "common/base/glob.h"
#include "common/base/json_tree.h"
#include "common/model/find_robots.h"
#include "worldfile/gazebo/gazebo_tree.h"
#include "worldfile/grids/grid_tree.h"
#include "worldfile/map/map_yaml.h"
#include "worldfile/models/crowd.h"
#include "worldfile/scenario/scenario_schema.h"
#include "worldfile/scenario/scenario_tree.h"
#include "worldfile/sites/building_yaml.h"
#include "worldfile/sites/lif_json.h"
#include "worldfile/sites/route_graph.h"
#include "worldfile/sites/site_tree.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// Reads a file that the scenario names by `name`. If it cannot be opened at all, the error names the scenario's line.
Result<WorldTree> ReadNamed(const PlacedText& name, const std::string& path, const AllowedPaths& allowed,
                            const ScenarioTools& tools) {
  Result<WorldTree> tree = tools.read_world(path, allowed);
  if (!tree.ok() && tree.error().where.line == 0) return Error{name.where, tree.error().message};
  return tree;
}

// Defines the models of files that the entries name.
Status DefineModelFiles(const std::vector<ModelEntry>& entries, const std::string& path, const AllowedPaths& allowed,
                        WorldTree& tree) {
  for (const ModelEntry& entry : entries) {
    if (entry.model && IsModelFile(entry.model->text)) {
      const std::string file = FindFile(entry.model->text, DirectoryOf(path), path);
      Status status = DefineModelFile(entry.model->text, file, entry.model->where, allowed, tree);
      if (!status.ok()) return status;
    }
    if (Status status = DefineModelFiles(entry.children, path, allowed, tree); !status.ok()) return status;
  }
  return Status();
}

Status DefineModelFiles(const ScenarioFile& file, const std::string& path, const LoadOverrides& overrides,
                        WorldTree& tree) {
  for (const auto* const entries : {&file.models, &file.robots}) {
    if (Status status = DefineModelFiles(*entries, path, overrides.allowed, tree); !status.ok()) return status;
  }
  for (const SpawnEntry& rule : file.spawns) {
    if (!IsModelFile(rule.model.text)) continue;
    const std::string model = FindFile(rule.model.text, DirectoryOf(path), path);
    Status status = DefineModelFile(rule.model.text, model, rule.model.where, overrides.allowed, tree);
    if (!status.ok()) return status;
  }
  return AddRobots(overrides.robots, overrides.allowed, tree);
}

Result<WorldTree> ReadTree(const ScenarioFile& file, const std::string& path, const LoadOverrides& overrides,
                           const ScenarioTools& tools) {
  const AllowedPaths& allowed = overrides.allowed;
  const std::string directory = DirectoryOf(path);
  const auto beside = [&](const std::string& name) {
    return (std::filesystem::path(directory) / name).lexically_normal().string();
  };
  Result<WorldTree> tree =
      file.world ? ReadNamed(*file.world, beside(file.world->text), allowed, tools) : ParseStageText("", path);
  if (!tree.ok()) return tree;
  // The scenario first: its name and folder stand for the whole in summaries.
  if (file.world) tree.value().files.insert(tree.value().files.begin(), path);
  for (const PlacedText& include : file.includes) {
    Result<WorldTree> included = ReadNamed(include, FindFile(include.text, directory, path), allowed, tools);
    if (!included.ok()) return included;
    tree = Merged(std::move(tree).value(), std::move(included).value(), include.where);
  }
  if (Status error = DefineModelFiles(file, path, overrides, tree.value()); !error.ok()) return error.error();
  return tree;
}

// Checks every controller that the scenario names.
Status CheckControllers(const ScenarioFile& file, const LoadOverrides& overrides) {
  if (!overrides.check_controller) return Status();
  const auto check = [&](const std::optional<ControllerEntry>& entry) -> Status {
    if (!entry) return Status();
    const Status checked = overrides.check_controller(entry->controller.name, entry->controller.parameters);
    if (checked.ok()) return Status();
    return Error{entry->where, checked.error().message, checked.error().code};
  };
  if (Status error = check(file.controller); !error.ok()) return error;
  for (const ModelEntry& robot : file.robots) {
    if (Status error = check(robot.controller); !error.ok()) return error;
  }
  for (const SpawnEntry& spawn : file.spawns) {
    if (Status error = check(spawn.controller); !error.ok()) return error;
  }
  return Status();
}

// Reads a scenario, with the checks that do not need its world.
Result<ScenarioFile> ReadText(const std::string& text, const std::string& path, const LoadOverrides& overrides,
                              const ScenarioTools& tools) {
  const Result<JsonTree> tree = JsonTree::Parse(text, path);
  if (!tree.ok()) return tree.error();
  if (Status error = CheckSchema(tree.value()); !error.ok()) return error.error();
  Result<ScenarioFile> file = ReadScenarioFile(tree.value(), DirectoryOf(path), tools.max_spawned);
  if (!file.ok()) return file;
  if (Status error = CheckControllers(file.value(), overrides); !error.ok()) return error.error();
  return file;
}

std::optional<ControllerDescription> DefaultController(const ScenarioFile& file, const LoadOverrides& overrides) {
  if (overrides.controller) return ControllerDescription{*overrides.controller, "{}"};
  if (file.controller) return file.controller->controller;
  return std::nullopt;
}

class Overrider {
 public:
  explicit Overrider(const OverrideEntry& rule) : rule_(rule) {}

  // The node with the changes of the rule below it; nothing if the rule matches none of the nodes there.
  std::optional<WorldNode> Visit(const WorldNode& parent, const std::string& parent_name) {
    std::optional<WorldNode> result;
    const std::vector<std::string> names = ChildNames(parent);
    for (std::size_t i = 0; i < parent.children.size(); ++i) {
      const WorldNode& child = parent.children[i];
      if (child.type == "block" || child.type == "window") continue;
      const std::string name = names[i].empty() ? "" : FullName(parent_name, names[i]);
      if (!name.empty()) names_.push_back(name);
      types_.insert(child.type);
      types_.insert(child.macros.begin(), child.macros.end());
      // Copies are made on the way back from a match only, so that a rule for one robot of 10,000 does not copy the
      // others' subtrees.
      std::optional<WorldNode> changed = Visit(child, name);
      if (Matches(child, name)) {
        ++matches_;
        if (!changed) changed = child;
        for (const Property& property : rule_.properties) changed->Set(property);
      }
      if (!changed) continue;
      if (!result) result = parent;
      result->children.Change(i) = std::move(*changed);
    }
    return result;
  }

  Status Outcome() const {
    if (matches_ > 0) return Status();
    std::string wanted;
    if (rule_.name) wanted += " with the name " + Quoted(*rule_.name);
    if (rule_.type) wanted += std::string(rule_.name ? " and" : " with") + " the type " + Quoted(*rule_.type);
    return Error{rule_.where, "found no model" + wanted + ", expected one of the names " + List(names_) +
                                  " or of the types " + List({types_.begin(), types_.end()})};
  }

 private:
  bool Matches(const WorldNode& node, const std::string& name) const {
    if (rule_.name && (name.empty() || !MatchesGlob(*rule_.name, name))) return false;
    if (!rule_.type || MatchesGlob(*rule_.type, node.type)) return true;
    return std::any_of(node.macros.begin(), node.macros.end(),
                       [this](const std::string& macro) { return MatchesGlob(*rule_.type, macro); });
  }

  static std::string List(const std::vector<std::string>& words) {
    constexpr std::size_t kMax = 12;
    if (words.empty()) return "(there are none)";
    std::string list;
    for (std::size_t i = 0; i < words.size() && i < kMax; ++i) list += (i > 0 ? ", " : "") + Quoted(words[i]);
    if (words.size() > kMax) list += " and " + std::to_string(words.size() - kMax) + " more";
    return list;
  }

  const OverrideEntry& rule_;
  int matches_ = 0;
  std::vector<std::string> names_;
  std::set<std::string> types_;
};

// Sets what the scenario says of the world and its run beside the tree.
void Complete(LoadedWorld& loaded, const ScenarioFile& file, const ScenarioPlan& plan) {
  // The world's settings hold where the scenario says nothing.
  const RunSettings of_world = loaded.settings;  // its quit_time and its speedup
  loaded.settings = file.settings;
  if (!loaded.settings.ticks) loaded.settings.ticks = of_world.ticks;
  const bool has_speed = loaded.settings.speed || !loaded.settings.watched_speed;
  if (!has_speed) loaded.settings.watched_speed = of_world.watched_speed;
  if (file.name) loaded.world.name = *file.name;
  // A place of the scenario replaces the building's place of its name.
  std::erase_if(loaded.world.places, [&](const NamedPlace& place) {
    return std::any_of(file.places.begin(), file.places.end(), [&](const auto& own) { return own.name == place.name; });
  });
  loaded.world.places.insert(loaded.world.places.end(), file.places.begin(), file.places.end());
  loaded.regions = file.regions;
  loaded.expectations = file.expectations;
  loaded.ros_lockstep = file.ros_lockstep;
  loaded.ros_lockstep.names.insert(loaded.ros_lockstep.names.end(), plan.ros_lockstep.begin(), plan.ros_lockstep.end());
  for (RobotDescription& robot : loaded.world.robots) {
    const auto controller = plan.controllers.find(robot.name);
    if (controller != plan.controllers.end()) robot.controller = controller->second;
    const auto domain = plan.ros_domains.find(robot.name);
    if (domain != plan.ros_domains.end()) robot.ros.domain = domain->second;
  }
  loaded.warnings.insert(loaded.warnings.begin(), file.warnings.begin(), file.warnings.end());
}

Status RemoveEntities(WorldTree& tree, const std::vector<PlacedText>& names) {
  std::vector<std::string> known = ChildNames(tree.world);
  for (std::string& name : known) name = name.empty() ? "" : FullName("", name);
  std::set<std::string> removed;
  for (const PlacedText& name : names) {
    if (std::find(known.begin(), known.end(), name.text) == known.end()) {
      return Error{name.where, "found no robot or model " + Quoted(name.text) +
                                   " to leave out, expected the name of one" + DidYouMean(name.text, known)};
    }
    removed.insert(name.text);
  }
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!removed.contains(known[i])) kept.push_back(i);
  }
  tree.world.children = tree.world.children.Selected(kept);
  return Status();
}

// Moves the models of `to` to the places of the models of their names in `from`.
void CopyPlaces(const WorldDescription& from, WorldDescription& to) {
  std::map<std::string, const ModelDescription*> models;
  for (const ModelDescription& model : from.models) models.emplace(model.name, &model);
  for (ModelDescription& model : to.models) {
    if (const auto found = models.find(model.name); !model.parent && found != models.end())
      model.X_PM = found->second->X_PM;
  }
  std::vector<std::string> names;
  for (const RobotDescription& robot : to.robots) names.push_back(robot.name);
  const std::vector<std::optional<RobotId>> robots = FindRobots(from, names);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (robots[i]) to.robots[i].localization = from.robot(*robots[i]).localization;
  }
}

// Appends the people of `from`, with their goals, to a world without people.
void CopyPeople(const WorldDescription& from, WorldDescription& to) {
  std::map<ShapeId, ShapeId> shapes;
  const auto shape_in = [&](ShapeId shape) {
    const auto [place, is_new] = shapes.emplace(shape, ShapeId(to.shapes.size()));
    if (is_new) to.shapes.push_back(from.shape(shape));
    return place->second;
  };
  to.goal_sets = from.goal_sets;
  to.visitor_flows = from.visitor_flows;
  to.visitors = from.visitors;
  to.exits = from.exits;
  for (PersonDescription person : from.people) {
    const std::size_t first = person.root.index();
    person.root = ModelId(to.models.size());
    for (std::size_t i = first; i < from.models.size() && IsInTree(from, ModelId(i), ModelId(first)); ++i) {
      ModelDescription part = from.models[i];
      part.shape = shape_in(part.shape);
      if (part.parent) part.parent = ModelId(part.parent->index() - first + person.root.index());
      to.models.push_back(std::move(part));
    }
    to.people.push_back(person);
  }
}

}  // namespace

Result<WorldTree> ReadWorldTree(const std::string& path, const AllowedPaths& allowed) {
  if (IsBuildingPath(path) || IsRouteGraphPath(path) || IsLayoutPath(path, allowed)) return ReadSiteTree(path, allowed);
  if (IsGridPath(path, allowed)) return ReadGridTree(path, {}, allowed);
  const std::string ending = std::filesystem::path(path).extension().string();
  if (IsGazeboPath(path, allowed)) return ReadGazeboTree(path, allowed);
  if (ending != ".yaml" && ending != ".yml") {
    Result<WorldTree> tree = ParseStageWorld(path, allowed);
    if (!tree.ok()) return tree;
    if (Status error = ExpandModelFiles(allowed, tree.value()); !error.ok()) return error.error();
    return tree;
  }
  // The tree only names the map: an unreadable one would be found too late to name the right line.
  const Result<MapYaml> map = ReadMapYaml(path, {path}, allowed);
  if (!map.ok()) return map.error();
  return MapYamlTree(path);
}

Result<LoadedWorld> LoadScenario(const std::string& path, const LoadOverrides& overrides) {
  const Result<std::string> text = ReadTextFile(path, {path, 0, 0}, overrides.allowed);
  if (!text.ok()) return text.error();
  return LoadScenarioText(text.value(), path, overrides);
}

Status CheckScenario(const std::string& path, const LoadOverrides& overrides) {
  if (IsLayoutPath(path, overrides.allowed) || IsGridPath(path, overrides.allowed)) return Status();
  const Result<std::string> text = ReadTextFile(path, {path, 0, 0}, overrides.allowed);
  if (!text.ok()) return text.error();
  const Result<ScenarioFile> file = ReadText(text.value(), path, overrides, ScenarioTools{});
  if (!file.ok()) return file.error();
  return Status();
}

Result<ScenarioWorld> ReadScenarioWorld(const std::string& path, const LoadOverrides& overrides) {
  const Result<std::string> text = ReadTextFile(path, {path, 0, 0}, overrides.allowed);
  if (!text.ok()) return text.error();
  return ReadScenarioWorldText(text.value(), path, overrides);
}

Result<ScenarioWorld> ReadScenarioWorldText(const std::string& text, const std::string& path,
                                            const LoadOverrides& overrides) {
  const ScenarioTools tools;
  const Result<ScenarioFile> file = ReadText(text, path, overrides, tools);
  if (!file.ok()) return file.error();
  Result<WorldTree> tree = ReadTree(file.value(), path, overrides, tools);
  if (!tree.ok()) return tree.error();
  for (const Property& property : file.value().properties) tree.value().world.Set(property);
  ScenarioWorld world{std::move(tree).value(), DefaultController(file.value(), overrides), {}};
  for (const SpawnEntry& rule : file.value().spawns) {
    if (rule.ros_domain && rule.ros_domain->each) {
      world.ros_domains_from.emplace(rule.model.text, rule.ros_domain->first);
    }
  }
  return world;
}

Result<WorldTree> ReadScenarioTree(const std::string& text, const std::string& path, const LoadOverrides& overrides) {
  const ScenarioTools tools;
  const Result<ScenarioFile> file = ReadText(text, path, overrides, tools);
  if (!file.ok()) return file.error();
  Result<WorldTree> tree = ReadTree(file.value(), path, overrides, tools);
  if (!tree.ok()) return tree;
  Result<ScenarioPlan> plan =
      ApplyScenario(file.value(), DefaultController(file.value(), overrides), std::move(tree).value());
  if (!plan.ok()) return plan.error();
  return std::move(plan.value().tree);
}

Result<HostsOfScenario> ReadHostsOfScenario(const std::string& path) {
  if (IsLayoutPath(path) || IsGridPath(path)) return HostsOfScenario();
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

  Result<WorldTree> tree = ReadTree(file, path, overrides, tools);
  if (!tree.ok()) return tree.error();
  Result<ScenarioPlan> plan = ApplyScenario(file, DefaultController(file, overrides), std::move(tree).value());
  if (!plan.ok()) return plan.error();
  LoadOverrides build;
  build.allowed = overrides.allowed;
  build.seed = overrides.seed ? overrides.seed : file.seed;
  Result<LoadedWorld> built = BuildWorld(plan.value().tree, build, tools.build);
  if (!built.ok()) return built;
  Complete(built.value(), file, plan.value());
  // Spawned models and people get their places before the `without` models are removed: leaving out one robot does not
  // move the others, and a comparison of runs with and without it is fair.
  const std::uint64_t seed = built.value().world.seed;
  built = PlaceSpawns(std::move(built).value(), plan.value().spawns, seed, tools.max_spawn_draws);
  if (!built.ok()) return built;
  built = AddCrowd(std::move(built).value());
  if (built.ok()) built = AddPeople(std::move(built).value(), file.people);
  if (built.ok()) {
    built = AddRecordedPeople(std::move(built).value(), file.recorded_people, path, overrides.allowed);
  }
  if (!built.ok()) return built;
  if (!file.without.empty()) {
    if (Status error = RemoveEntities(plan.value().tree, file.without); !error.ok()) return error.error();
    // Built again instead of erased from the built world: ids of models, robots and shapes are dense, and references
    // between them are many.
    Result<LoadedWorld> reduced = BuildWorld(plan.value().tree, build, tools.build);
    if (!reduced.ok()) return reduced;
    Complete(reduced.value(), file, plan.value());
    CopyPlaces(built.value().world, reduced.value().world);
    CopyPeople(built.value().world, reduced.value().world);
    built = std::move(reduced);
  }
  PrepareLanes(built.value(), path);
  if (Status error = AddSiteEntries(file.site, path, overrides.allowed, built.value()); !error.ok())
    return error.error();
  if (Status error = CheckControllersInWorld(built.value(), path, overrides); !error.ok()) return error.error();
  return built;
}

Result<WorldNode> ApplyOverride(const OverrideEntry& rule, WorldNode world) {
  Overrider overrider(rule);
  std::optional<WorldNode> changed = overrider.Visit(world, "");
  if (Status error = overrider.Outcome(); !error.ok()) return error.error();
  return std::move(changed).value_or(std::move(world));
}

}  // namespace troupe
