#include "worldfile/load_world.h"

#include <filesystem>
#include <variant>
#include <vector>

#include "worldfile/map/map_yaml.h"
#include "worldfile/models/build_world.h"
#include "worldfile/models/start_overlap.h"
#include "worldfile/models/types/stage_controllers.h"
#include "worldfile/scenario/scenario.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

Result<LoadedWorld> LoadStageWorld(const std::string& path, const LoadOverrides& overrides) {
  const Result<WorldTree> tree = ParseStageWorld(path, overrides.allowed);
  if (!tree.ok()) return tree.error();
  return BuildWorld(tree.value(), overrides);
}

Result<LoadedWorld> LoadByEnding(const std::string& path, const LoadOverrides& overrides) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".world") return LoadStageWorld(path, overrides);
  if (ending == ".json") return LoadScenario(path, overrides);
  if (ending == ".yaml" || ending == ".yml") return BuildWorld(MapYamlTree(path), overrides);
  return Error{
      {path},
      "found a file ending in " + Quoted(ending) + ", expected .world (Stage), .json (scenario) or .yaml (ROS map)"};
}

}  // namespace

Result<LoadedWorld> LoadWorld(const std::string& path, const LoadOverrides& overrides) {
  Result<LoadedWorld> loaded = LoadByEnding(path, overrides);
  if (loaded.ok()) {
    for (const std::string& message : FindStartOverlaps(loaded.value().world)) {
      loaded.value().warnings.push_back({{path}, message});
    }
  }
  return loaded;
}

namespace {

std::vector<std::string> TextsOf(const Value& value) {
  std::vector<std::string> texts;
  if (const auto* const text = std::get_if<std::string>(&value.content)) texts.push_back(*text);
  if (const auto* const tuple = std::get_if<std::vector<Value::Scalar>>(&value.content)) {
    for (const Value::Scalar& scalar : *tuple) {
      if (const auto* const text = std::get_if<std::string>(&scalar)) texts.push_back(*text);
    }
  }
  return texts;
}

// The first known controller of a robot counts.
Status CheckRobot(const WorldNode& robot, const LoadOverrides& overrides) {
  const Property* const property = robot.Find("ctrl");
  if (property == nullptr) return {};
  for (const std::string& text : TextsOf(property->value)) {
    const Result<std::optional<StageController>> read = ReadStageController(text);
    if (!read.ok()) return Error{property->value.where, read.error().message};
    if (!read.value()) continue;
    const ControllerDescription& controller = read.value()->description;
    const Status checked = overrides.check_controller(controller.name, controller.parameters);
    return checked.ok() ? Status() : Error{property->value.where, checked.error().message};
  }
  return {};
}

// A `position` on a robot is a part of it, without a controller.
Status CheckNodes(const WorldNode& node, const LoadOverrides& overrides) {
  for (const WorldNode& child : node.children) {
    Status status = child.type == "position" ? CheckRobot(child, overrides) : CheckNodes(child, overrides);
    if (!status.ok()) return status;
  }
  return {};
}

}  // namespace

Status CheckCtrl(const std::string& path, const LoadOverrides& overrides) {
  const Result<WorldTree> tree = ParseStageWorld(path, overrides.allowed);
  return tree.ok() ? CheckNodes(tree.value().world, overrides) : Status();
}

}  // namespace troupe
