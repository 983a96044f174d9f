// The requests of the page that concern the file as a whole, the properties of its entities, and whole models: walls
// and rooms, and the defines of the model editor.
#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "viewer/editor/editor.h"
#include "viewer/editor/model_parts.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/edit/written_model.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

}  // namespace

Result<Json> Editor::Done(const Status& status) {
  if (!status.ok()) return status.error();
  return Json::object();
}

Result<Json> Editor::Execute(const edit::Text&) const {
  if (FindInvalidUtf8(text()) != std::string::npos) return Error{{}, "the file is not UTF-8; edit its text elsewhere"};
  return Json{{"text", text()}};
}

// The text of a user may have an error: it stays as it is typed, with the world of before.
Result<Json> Editor::Execute(const edit::SetText& operation) {
  file_.Change(operation.text, "the change of the text");
  Load();
  return Json{{"error", error_ ? error_->ToString() : ""}};
}

// Files of images that the text no longer names are not written.
Result<Json> Editor::Execute(const edit::Save& operation) {
  return Done(file_.Save(operation.overwrite, NamedImages()));
}

Result<Json> Editor::Execute(const edit::Reload&) {
  if (Status failure = file_.Reload(); !failure.ok()) return failure.error();
  Load();
  return Json::object();
}

Result<Json> Editor::Execute(const edit::Undo&) {
  const std::optional<std::string> label = file_.undo_label();
  if (!label) return Error{{}, "there is nothing to undo"};
  file_.Undo();
  Load();
  return Json{{"label", *label}};
}

Result<Json> Editor::Execute(const edit::Redo&) {
  const std::optional<std::string> label = file_.redo_label();
  if (!label) return Error{{}, "there is nothing to redo"};
  file_.Redo();
  Load();
  return Json{{"label", *label}};
}

Result<Json> Editor::Execute(const edit::SetPose& operation) {
  return Done(SetPose(operation.name, operation.pose));
}

Result<Json> Editor::Execute(const edit::Delete& operation) {
  return Done(Remove(operation.name));
}

Result<Json> Editor::Execute(const edit::Rename& operation) {
  return Done(Rename(operation.name, operation.to));
}

// In a scenario `pose` and `name` are members of the entry, all else is in its object `properties`.
Status Editor::SetBody(const Place& place, const std::string& name, const std::optional<Value>& value,
                       const std::string& label) {
  if (place.statement != nullptr) {
    const StageBody body = BodyOf(*place.statement);
    return Commit(value ? WithProperty(text(), body, name, *value) : WithoutProperty(text(), body, name), label);
  }
  const bool is_member = name == "pose" || name == "name";
  Result<std::string> changed =
      WithValueAt(place.text, *place.entry, is_member ? JsonPath{name} : JsonPath{"properties", name},
                  value ? std::optional(ToJson(*value)) : std::nullopt);
  return changed.ok() ? Commit(std::move(changed).value(), label) : Status(changed.error());
}

// The name of an entity is changed by Rename, which checks that it is free.
Status Editor::ChangeProperty(const edit::SetProperty& operation) {
  const auto& [name, change] = operation;
  const auto& [property, value] = change;
  if (name.empty()) {
    if (Status broken = CheckText(); !broken.ok()) return broken;
    const std::string label = "the " + property + " of the world";
    if (kind_ == EditedKind::kScenario) {
      const Result<Place> scenario = PlaceOfScenario();
      return scenario.ok() ? SetBody(scenario.value(), property, value, label) : Status(scenario.error());
    }
    const Result<StageTree> tree = ParseStage(text(), path());
    if (!tree.ok()) return tree.error();
    const StageBody body = tree.value().body();
    return Commit(value ? WithProperty(text(), body, property, *value) : WithoutProperty(text(), body, property),
                  label);
  }
  const Result<const EditedEntity*> entity = FindEntity(name);
  if (!entity.ok()) return entity.error();
  if (property == "name") {
    const auto* const text = value ? std::get_if<std::string>(&value->content) : nullptr;
    if (text == nullptr) return Error{{}, "found no text, expected a name in double quotes"};
    return Rename(name, *text);
  }
  const Result<Place> place = PlaceOf(*entity.value());
  if (!place.ok()) return place.error();
  return SetBody(place.value(), property, value, fmt::format("the {} of {}", property, name));
}

// A new warning about the property is a part of the reply: the property is set, and has no effect.
Result<Json> Editor::Execute(const edit::SetProperty& operation) {
  const std::size_t warnings_before = world_ != nullptr ? world_->loaded.warnings.size() : 0;
  if (Status failure = ChangeProperty(operation); !failure.ok()) return failure.error();
  Json reply = Json::object();
  const std::vector<Warning>& warnings = world_->loaded.warnings;
  if (warnings.size() <= warnings_before) return reply;
  for (const Warning& warning : warnings) {
    const bool names_it = warning.message.find("'" + operation.change.property + "'") != std::string::npos;
    if (names_it) reply["warning"] = warning.ToString();
  }
  return reply;
}

Result<Json> Editor::Execute(const edit::Copy& operation) {
  Result<std::string> name = Copy(operation.name, operation.pose);
  if (!name.ok()) return name.error();
  return Json{{"name", std::move(name).value()}};
}

// Each is loaded before the next, because places in the text are those of the text as it is then.
Result<Json> Editor::Execute(const edit::Together& operation) {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  Json names = Json::array();
  const auto apply = [&](const auto& each) -> Status {
    Result<Json> reply = Execute(each);
    if (!reply.ok()) return reply.error();
    names.push_back(reply.value().value("name", each.name));
    return {};
  };
  file_.BeginJoined();
  for (const auto& each : operation.edits) {
    const Status status = std::visit(apply, each);
    if (status.ok()) continue;
    file_.CancelJoined();
    Load();
    return status.error();
  }
  constexpr std::array kLabels{"the move of ", "the deletion of ", "the addition of "};
  const std::size_t count = operation.edits.size();
  const std::string what = count == 1 ? names[0].get<std::string>() : fmt::format("{} models", count);
  file_.EndJoined(kLabels.at(operation.edits.front().index()) + what);
  return Json{{"names", std::move(names)}};
}

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
  Result<std::string> added = WithAdded(text(), model, false);
  if (!added.ok()) return added.error();
  if (Status failure = Commit(std::move(added).value(), "the addition of " + name); !failure.ok())
    return failure.error();
  return Json{{"name", name}};
}

// With a base a new define is made; without one the define of this file is changed.
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
