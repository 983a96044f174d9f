#include "worldfile/check_ctrl.h"

#include <variant>
#include <vector>

#include "worldfile/models/types/stage_controllers.h"
#include "worldfile/stage/stage_world.h"

namespace troupe {
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
