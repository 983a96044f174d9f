// The requests of the page that concern whole models: walls and rooms, and the defines of the model editor.
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "viewer/editor/editor.h"
#include "viewer/editor/file_values.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

}  // namespace

// A single upright box has no blocks but its size.
Result<Json> Editor::Execute(const edit::AddModel& operation) {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  const bool is_scenario = kind_ == EditedKind::kScenario;
  const FileUnits units = UnitsOf(world_->tree.world);
  const std::vector<DrawnBlock> blocks = BlocksInFrame(operation.blocks, Pose{}, units.metres);
  const Pose& pose = operation.pose;
  const std::string name = FreeName(operation.prefix);

  WrittenModel model{"model", {}, {}};
  model.Set("name", Text(name));
  const double scale = is_scenario ? 1.0 : 1.0 / units.metres;
  const double degrees = pose.heading * 180.0 / std::numbers::pi;
  std::vector<double> numbers{pose.x * scale, pose.y * scale, pose.z * scale,
                              !is_scenario && units.radians == 1.0 ? pose.heading : degrees};
  if (is_scenario && pose.z == 0.0) numbers.erase(numbers.begin() + 2);
  model.Set("pose", Tuple(numbers));
  FittedBody body = Fitted(blocks);
  model.Set("size", body.size);
  if (!body.is_centred) model.Set("origin", body.origin);
  for (const auto& [property, value] : operation.properties) model.Set(property, value);
  if (!IsBox(blocks)) model.children = std::move(body.blocks);
  Result<std::string> added = WithAdded(model);
  if (!added.ok()) return added.error();
  if (Status failure = Commit(std::move(added).value(), "the addition of " + name); !failure.ok())
    return failure.error();
  return Json{{"name", name}};
}

Result<Json> Editor::Execute(const edit::SetModel& operation) {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  if (kind_ == EditedKind::kScenario) {
    return Error{{}, "a scenario has no models of its own: edit the .inc or .world file that it names"};
  }
  const std::string& name = operation.name;
  const std::string& base = operation.base;
  const std::vector<DrawnBlock> drawn = BlocksInFrame(operation.blocks, Pose{}, UnitsOf(world_->tree.world).metres);
  const Result<StageTree> syntax = ParseStage(text(), path());
  if (!syntax.ok()) return syntax.error();
  const auto known = world_->tree.defines.find(name);
  if (!base.empty()) {
    if (known != world_->tree.defines.end())
      return Error{{}, "found the model " + Quoted(name) + " in use, expected another name"};
    WrittenModel model{base, {}, {}};
    if (!drawn.empty()) {
      FittedBody body = Fitted(drawn);
      model.Set("size", body.size);
      if (!body.is_centred) model.Set("origin", body.origin);
      model.children = std::move(body.blocks);
    }
    for (const auto& [property, value] : operation.properties) model.Set(property, value);
    return Done(Commit(WithDefine(text(), syntax.value(), name, model), "the new model " + name, name));
  }
  if (known == world_->tree.defines.end() || known->second.where.file != path()) {
    return Error{{}, "found no model " + Quoted(name) + " in this file"};
  }
  const Statement* const define = FindDefine(syntax.value(), name);
  if (define == nullptr) return Error{{}, "found no model " + Quoted(name) + " in this file"};
  StageBodyEdit edit(text(), path(), define->line, define->column);
  if (!drawn.empty()) {
    const FittedBody body = Fitted(drawn);
    if (Status failure = edit.Set("size", body.size); !failure.ok()) return failure.error();
    const Result<WorldNode> node = Instantiate(world_->tree, name, {});
    const bool has_origin = node.ok() && node.value().Find("origin") != nullptr;
    if (!body.is_centred || has_origin) {
      if (Status failure = edit.Set("origin", body.origin); !failure.ok()) return failure.error();
    }
    if (Status failure = edit.SetBlocks(body.blocks); !failure.ok()) return failure.error();
  }
  for (const auto& [property, value] : operation.properties) {
    if (Status failure = edit.Set(property, value); !failure.ok()) return failure.error();
  }
  for (const std::string& property : operation.removed) {
    if (Status failure = edit.Remove(property); !failure.ok()) return failure.error();
  }
  return Done(Commit(edit.text(), "the change of model " + name, name));
}

}  // namespace troupe
