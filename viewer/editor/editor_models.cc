// The requests of the page that concern whole models: walls and rooms, and the defines of the model editor.
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "viewer/editor/editor.h"
#include "viewer/editor/editor_place.h"
#include "viewer/editor/fitted_body.h"
#include "viewer/editor/property_text.h"
#include "viewer/editor/request_values.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

}  // namespace

// {"name": prefix, "pose": [x, y, z, heading], "blocks": ..., "properties": {...}}: a static model of its own, for
// instance a wall or a room. A single upright box has no blocks but its size.
Result<Json> Editor::AddModel(const Json& request) {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  const bool is_scenario = kind_ == EditedKind::kScenario;
  const FileUnits units = UnitsOf(world_->tree);
  const Result<std::vector<DrawnBlock>> blocks = BlocksIn(request, units.metres);
  if (!blocks.ok()) return blocks.error();
  const std::optional<Pose> pose = PoseIn(request, "pose");
  if (!pose || blocks.value().empty()) return Error{{}, "found no pose or no blocks"};
  Result<std::vector<std::pair<std::string, WrittenValue>>> properties = PropertiesIn(request);
  if (!properties.ok()) return properties.error();
  const std::string prefix = TextIn(request, "name");
  if (Status wrong = CheckName(prefix); !wrong.ok()) return wrong.error();
  const std::string name = FreeName(prefix);

  WrittenModel model{"model", {}, {}};
  model.Set("name", Text(name));
  const double scale = is_scenario ? 1.0 : 1.0 / units.metres;
  const double degrees = pose->heading * 180.0 / std::numbers::pi;
  std::vector<double> numbers{pose->x * scale, pose->y * scale, pose->z * scale,
                              !is_scenario && units.radians == 1.0 ? pose->heading : degrees};
  if (is_scenario && pose->z == 0.0) numbers.erase(numbers.begin() + 2);
  model.Set("pose", Tuple(numbers));
  FittedBody body = Fitted(blocks.value());
  model.Set("size", body.size);
  if (!body.is_centred) model.Set("origin", body.origin);
  for (auto& [property, value] : properties.value()) model.Set(property, std::move(value));
  if (!IsBox(blocks.value())) model.children = std::move(body.blocks);
  Result<std::string> added = WithAdded(model);
  if (!added.ok()) return added.error();
  if (Status failure = Commit(std::move(added).value(), "the addition of " + name); !failure.ok())
    return failure.error();
  return Json{{"name", name}};
}

// {"name", "base": of a new one, "blocks": ..., "properties": {...}, "remove": [names]}
Result<Json> Editor::SetModel(const Json& request) {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  if (kind_ == EditedKind::kScenario) {
    return Error{{}, "a scenario has no models of its own: edit the .inc or .world file that it names"};
  }
  const std::string name = TextIn(request, "name");
  if (!IsTypeName(name))
    return Error{{}, "found the name " + Quoted(name) + ", expected a letter, then letters, digits, . - _"};
  const FileUnits units = UnitsOf(world_->tree);
  std::vector<DrawnBlock> drawn;
  if (request.contains("blocks")) {
    Result<std::vector<DrawnBlock>> blocks = BlocksIn(request, units.metres);
    if (!blocks.ok()) return blocks.error();
    drawn = std::move(blocks).value();
  }
  Result<std::vector<std::pair<std::string, WrittenValue>>> properties = PropertiesIn(request);
  if (!properties.ok()) return properties.error();
  const Result<StageTree> syntax = ParseStage(text(), path());
  if (!syntax.ok()) return syntax.error();
  const auto known = world_->tree.defines.find(name);
  if (const std::string base = TextIn(request, "base"); !base.empty()) {
    if (known != world_->tree.defines.end())
      return Error{{}, "found the model " + Quoted(name) + " in use, expected another name"};
    if (!IsTypeName(base)) return Error{{}, "found the base " + Quoted(base) + ", expected a model"};
    WrittenModel model{base, {}, {}};
    if (!drawn.empty()) {
      FittedBody body = Fitted(drawn);
      model.Set("size", body.size);
      if (!body.is_centred) model.Set("origin", body.origin);
      model.children = std::move(body.blocks);
    }
    for (auto& [property, value] : properties.value()) model.Set(property, std::move(value));
    const std::string text_now = WithDefine(text(), syntax.value(), name, model);
    if (Status failure = Commit(text_now, "the new model " + name, name); !failure.ok()) return failure.error();
    return Json::object();
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
  for (const auto& [property, value] : properties.value()) {
    if (Status failure = edit.Set(property, value); !failure.ok()) return failure.error();
  }
  if (const auto removed = request.find("remove"); removed != request.end() && removed->is_array()) {
    for (const Json& property : *removed) {
      if (!property.is_string()) continue;
      if (Status failure = edit.Remove(property.get<std::string>()); !failure.ok()) return failure.error();
    }
  }
  if (Status failure = Commit(edit.text(), "the change of model " + name, name); !failure.ok()) {
    return failure.error();
  }
  return Json::object();
}

}  // namespace troupe
