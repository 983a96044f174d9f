// The requests of the page that concern the file as a whole, the properties of its entities, and whole models: walls
// and rooms, and the defines of the model editor.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "viewer/editor/editor.h"
#include "viewer/editor/model_parts.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/edit/written_model.h"
#include "worldfile/scenario/scenario_schema.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostPictures = 300;  // of the palette
constexpr std::size_t kMostWarnings = 200;  // in a reply

const char* KindText(EditedKind kind) {
  return kind == EditedKind::kWorld ? "world" : kind == EditedKind::kInclude ? "include" : "scenario";
}

Json WhereJson(const SourceLocation& where) {
  return {{"file", where.file}, {"line", where.line}, {"column", where.column}};
}

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

Result<Json> Editor::Execute(const edit::Help&) const {
  Json table = Json::array();
  for (const PropertyHelp& row : PropertyTable()) {
    table.push_back({{"type", row.type},
                     {"name", row.name},
                     {"form", row.form},
                     {"unit", row.unit},
                     {"initial", row.initial},
                     {"help", row.help}});
  }
  return Json{{"properties", std::move(table)}, {"schema", Json::parse(kScenarioSchemaText, nullptr, false)}};
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

Result<Json> Editor::Execute(const edit::Document&) const {
  Json document = {{"file", path()},
                   {"kind", KindText(kind_)},
                   {"modified", is_modified()},
                   {"version", version_},
                   {"error", error_ ? error_->ToString() : ""}};
  if (error_) document["error_place"] = WhereJson(error_->where);
  document["undo"] = file_.undo_label().value_or("");
  document["redo"] = file_.redo_label().value_or("");
  Json warnings = Json::array();
  Json entities = Json::array();
  Json regions = Json::array();
  Json members = Json::object();
  Json properties = Json::array();
  if (world_ != nullptr) {
    for (const Property& property : world_->tree.world.properties) {
      properties.push_back({{"name", property.name}, {"value", ToStage(property.value)}});
    }
    for (const Warning& warning : world_->loaded.warnings) {
      if (warnings.size() < kMostWarnings) warnings.push_back(warning.ToString());
    }
    for (const EditedEntity& entity : world_->entities) {
      entities.push_back({{"name", entity.name},
                          {"type", entity.type},
                          {"model", entity.written},
                          {"here", entity.where.file == path()},
                          {"where", WhereJson(entity.where)}});
    }
  }
  if (kind_ == EditedKind::kScenario) {
    const Result<JsonTree> tree = JsonTree::Parse(text(), path());
    const JsonNode root = tree.ok() ? tree.value().root() : JsonNode();
    if (const JsonNode* const spawn = root.Find("spawn")) regions = ToJson(*spawn);
    for (const JsonNode& member : root.items) {
      if (root.is_object() && !member.is_array() && !member.is_object()) members[member.key] = ToJson(member);
    }
  }
  document["members"] = std::move(members);
  document["properties"] = std::move(properties);
  document["warnings"] = std::move(warnings);
  document["entities"] = std::move(entities);
  document["regions"] = std::move(regions);
  return document;
}

Result<Json> Editor::Execute(const edit::Palette&) const {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  Json models = Json::array();
  for (const PaletteModel& model : PaletteOf(world_->tree)) {
    Json row = {{"name", model.name},
                {"type", model.type},
                {"here", model.where.file == path()},
                {"where", WhereJson(model.where)}};
    if (models.size() < kMostPictures) {
      const Result<LoadedWorld> alone = BuildAlone(world_->tree, model.name, files());
      if (alone.ok()) row["picture"] = PictureOf(alone.value().world);
    }
    models.push_back(std::move(row));
  }
  return Json{{"models", std::move(models)}};
}

Result<Json> Editor::Execute(const edit::Entity& operation) const {
  const Result<const EditedEntity*> found = FindEntity(operation.name);
  if (!found.ok()) return found.error();
  const EditedEntity& entity = *found.value();
  const Result<Place> place = PlaceOf(entity);
  Json report = {{"name", entity.name},
                 {"type", entity.type},
                 {"model", entity.written},
                 {"where", WhereJson(entity.where)},
                 {"shelf", entity.on_shelf}};
  report["refusal"] = place.ok() ? "" : place.error().message;
  Json properties = Json::array();
  for (const Property& property : entity.node->properties) {
    bool own = false;
    if (place.ok() && place.value().statement != nullptr) {
      own = FindProperty(BodyOf(*place.value().statement), property.name) != nullptr;
    } else if (place.ok() && place.value().entry != nullptr) {
      const TextSpan& span = place.value().entry->span;
      const bool here = property.where.file == path() && property.where.line > 0;
      own = here && span.Contains(place.value().json->OffsetOf(property.where));
    }
    properties.push_back({{"name", property.name},
                          {"value", ToStage(property.value)},
                          {"own", own},
                          {"where", WhereJson(property.where)}});
  }
  report["properties"] = std::move(properties);
  return report;
}

Status Editor::SetBody(const Place& place, const std::string& name, const std::optional<Value>& value,
                       const std::string& label) {
  if (place.statement != nullptr) {
    const StageBody body = BodyOf(*place.statement);
    return Commit(value ? WithProperty(text(), body, name, *value) : WithoutProperty(text(), body, name), label);
  }
  const JsonNode& entry = *place.entry;
  const JsonNode* const holder = name == "pose" || name == "name" ? &entry : entry.Find("properties");
  if (!value) return holder != nullptr ? Commit(WithoutMember(text(), *holder, name), label) : Status();
  if (holder != nullptr) return Commit(WithMember(text(), *holder, name, ToJson(*value)), label);
  return Commit(WithMember(text(), entry, "properties", "{" + Json(name).dump() + ": " + ToJson(*value) + "}"), label);
}

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

Result<Json> Editor::Execute(const edit::SetMember& operation) {
  if (kind_ != EditedKind::kScenario) return Error{{}, "found no scenario"};
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  const auto find_place = [&]() -> Result<Place> {
    if (operation.name.empty()) return PlaceOfScenario();
    const Result<const EditedEntity*> entity = FindEntity(operation.name);
    if (!entity.ok()) return entity.error();
    return PlaceOf(*entity.value());
  };
  const Result<Place> place = find_place();
  if (!place.ok()) return place.error();
  const JsonNode& entry = *place.value().entry;
  std::string changed = operation.value ? WithMember(text(), entry, operation.key, *operation.value)
                                        : WithoutMember(text(), entry, operation.key);
  return Done(Commit(std::move(changed), "the change of " + operation.key));
}

Result<Json> Editor::Execute(const edit::SetRegion& operation) {
  if (kind_ != EditedKind::kScenario) return Error{{}, "spawn regions belong to scenarios (.json)"};
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  const Result<JsonTree> read = JsonTree::Parse(text(), path());
  if (!read.ok()) return read.error();
  const JsonNode& root = read.value().root();
  const JsonNode* const list = root.Find("spawn");
  if (!operation.index) {
    // One line, as rules are written by hand.
    std::string rule = "{";
    for (const auto& [key, value] : *operation.rule) {
      rule += (rule.size() > 1 ? ", " : "") + Json(key).dump() + ": " + value;
    }
    rule += "}";
    std::string changed = list != nullptr ? WithElement(text(), *list, rule)
                                          : WithMember(text(), root, "spawn", "[\n    " + rule + "\n  ]");
    return Done(Commit(std::move(changed), "the new spawn region"));
  }
  const std::size_t index = *operation.index;
  if (list == nullptr || index >= list->items.size()) return Error{{}, "found no spawn rule of that number"};
  if (!operation.rule) return Done(Commit(WithoutItem(text(), *list, index), "the deletion of a spawn region"));
  // Member by member, so that the rest of the rule stays as it is written.
  std::string changed = text();
  for (const auto& [key, value] : *operation.rule) {
    const Result<JsonTree> now = JsonTree::Parse(changed, path());
    if (!now.ok()) return now.error();
    changed = WithMember(changed, now.value().root().Member("spawn").items[index], key, value);
  }
  return Done(Commit(std::move(changed), "the change of a spawn region"));
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
