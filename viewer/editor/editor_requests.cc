// The requests of the page that concern the file as a whole, and the properties of its entities.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/json_text.h"
#include "viewer/editor/editor.h"
#include "viewer/editor/editor_place.h"
#include "viewer/editor/model_picture.h"
#include "viewer/editor/property_text.h"
#include "viewer/editor/request_values.h"
#include "worldfile/edit/json_edit.h"
#include "worldfile/edit/property_table.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/scenario/scenario_schema_text.h"
#include "worldfile/text/quote.h"

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

Result<Json> Editor::Apply(const Json& request) {
  const std::string op = TextIn(request, "op");
  const auto done = [](const Status& status) -> Result<Json> {
    if (!status.ok()) return status.error();
    return Json::object();
  };
  if (op == "document") return Document();
  if (op == "text") {
    if (FindInvalidUtf8(text()) != std::string::npos)
      return Error{{}, "the file is not UTF-8; edit its text elsewhere"};
    return Json{{"text", text()}};
  }
  if (op == "set_text") return SetText(request);
  if (op == "save") return done(file_.Save(request.value("overwrite", Json()) == true, NamedImages()));
  if (op == "reload") {
    if (Status failure = file_.Reload(); !failure.ok()) return failure.error();
    Load();
    return Json::object();
  }
  if (op == "undo" || op == "redo") {
    const bool undo = op == "undo";
    const std::optional<std::string> label = undo ? file_.undo_label() : file_.redo_label();
    if (!label) return Error{{}, undo ? "there is nothing to undo" : "there is nothing to redo"};
    undo ? file_.Undo() : file_.Redo();
    Load();
    return Json{{"label", *label}};
  }
  if (op == "palette") return Palette();
  if (op == "help") {
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
  if (op == "entity") return EntityReport(TextIn(request, "name"));
  if (op == "set_property") return SetProperty(request);
  if (op == "set_member") return SetMember(request);
  if (op == "set_pose") {
    const std::optional<Pose> pose = PoseIn(request, "pose");
    if (!pose) return Error{{}, "found no pose, expected four finite numbers"};
    return done(SetPose(TextIn(request, "name"), *pose));
  }
  if (op == "delete") return done(Remove(TextIn(request, "name")));
  if (op == "rename") return done(Rename(TextIn(request, "name"), TextIn(request, "to")));
  if (op == "add_model") return AddModel(request);
  if (op == "bitmaps") return BitmapReport();
  if (op == "create_bitmap") return CreateBitmap(request);
  if (op == "draw_bitmap") return DrawBitmap(request);
  if (op == "model") return ModelReport(TextIn(request, "name"));
  if (op == "set_model") return SetModel(request);
  if (op == "change_part") return ChangePart(request);
  if (op == "set_region") return SetRegion(request);
  return Error{{}, "found the operation " + Quoted(op) + ", expected one of the editor"};
}

Result<Json> Editor::Document() const {
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
      properties.push_back({{"name", property.name}, {"value", ValueText(property.value)}});
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
    const Json scenario = Json::parse(text(), nullptr, false);
    if (scenario.is_object() && scenario.contains("spawn")) regions = scenario["spawn"];
    for (const auto& [key, member] : scenario.items()) {
      if (member.is_primitive()) members[key] = member;
    }
  }
  document["members"] = std::move(members);
  document["properties"] = std::move(properties);
  document["warnings"] = std::move(warnings);
  document["entities"] = std::move(entities);
  document["regions"] = std::move(regions);
  return document;
}

// The text of a user may have an error: it stays as it is typed, with the world of before.
Result<Json> Editor::SetText(const Json& request) {
  if (!request.contains("text") || !request["text"].is_string()) return Error{{}, "found no text"};
  file_.Change(TextIn(request, "text"), "the change of the text");
  Load();
  return Json{{"error", error_ ? error_->ToString() : ""}};
}

Result<Json> Editor::Palette() const {
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

Result<Json> Editor::EntityReport(const std::string& name) const {
  const Result<const EditedEntity*> found = FindEntity(name);
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
                          {"value", ValueText(property.value)},
                          {"own", own},
                          {"where", WhereJson(property.where)}});
  }
  report["properties"] = std::move(properties);
  return report;
}

Status Editor::SetBody(const Place& place, const std::string& name, const std::optional<WrittenValue>& value,
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

// {"name": entity, "property": ..., "value": text or null}; without "name" a property of the world.
Result<Json> Editor::SetProperty(const Json& request) {
  const Result<PropertyChange> change = PropertyChangeIn(request);
  if (!change.ok()) return change.error();
  const auto& [property, value] = change.value();
  const std::size_t warnings_before = world_ != nullptr ? world_->loaded.warnings.size() : 0;
  Status status;
  if (const std::string name = TextIn(request, "name"); !name.empty()) {
    const Result<const EditedEntity*> entity = FindEntity(name);
    if (!entity.ok()) return entity.error();
    if (property == "name") {
      const auto* const scalar = value ? std::get_if<WrittenScalar>(&value->content) : nullptr;
      const auto* const text = scalar != nullptr ? std::get_if<std::string>(scalar) : nullptr;
      if (text == nullptr) return Error{{}, "found no text, expected a name in double quotes"};
      status = Rename(name, *text);
    } else {
      const Result<Place> place = PlaceOf(*entity.value());
      if (!place.ok()) return place.error();
      status = SetBody(place.value(), property, value, fmt::format("the {} of {}", property, name));
    }
  } else {
    if (Status broken = CheckText(); !broken.ok()) return broken.error();
    const std::string label = "the " + property + " of the world";
    if (kind_ == EditedKind::kScenario) {
      Place place;
      Result<JsonTree> json = JsonTree::Parse(text(), path());
      if (!json.ok()) return json.error();
      place.json = std::make_unique<JsonTree>(std::move(json).value());
      place.entry = &place.json->root();
      status = SetBody(place, property, value, label);
    } else {
      const Result<StageTree> syntax = ParseStage(text(), path());
      if (!syntax.ok()) return syntax.error();
      const StageBody body = syntax.value().body();
      status =
          Commit(value ? WithProperty(text(), body, property, *value) : WithoutProperty(text(), body, property), label);
    }
  }
  if (!status.ok()) return status.error();
  Json reply = Json::object();
  const std::vector<Warning>& warnings = world_->loaded.warnings;
  if (warnings.size() > warnings_before) {
    for (const Warning& warning : warnings) {
      if (warning.message.find("'" + property + "'") != std::string::npos) reply["warning"] = warning.ToString();
    }
  }
  return reply;
}

// {"name": entity, "key", "value": JSON or null}: a member of a scenario's entry; without "name" of the scenario.
Result<Json> Editor::SetMember(const Json& request) {
  if (kind_ != EditedKind::kScenario) return Error{{}, "found no scenario"};
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  const std::string key = TextIn(request, "key");
  if (!IsPropertyName(key)) return Error{{}, "found the key " + Quoted(key) + ", expected a name"};
  Place place;
  if (const std::string name = TextIn(request, "name"); !name.empty()) {
    const Result<const EditedEntity*> entity = FindEntity(name);
    if (!entity.ok()) return entity.error();
    Result<Place> found = PlaceOf(*entity.value());
    if (!found.ok()) return found.error();
    place = std::move(found).value();
  } else {
    Result<JsonTree> json = JsonTree::Parse(text(), path());
    if (!json.ok()) return json.error();
    place.json = std::make_unique<JsonTree>(std::move(json).value());
    place.entry = &place.json->root();
  }
  const auto value = request.find("value");
  const bool sets = value != request.end() && !value->is_null();
  std::string changed =
      sets ? WithMember(text(), *place.entry, key, JsonText(*value)) : WithoutMember(text(), *place.entry, key);
  if (Status failure = Commit(std::move(changed), "the change of " + key); !failure.ok()) return failure.error();
  return Json::object();
}

// {"index": of the rule, none: a new one, "rule": an object of the schema, or null: the rule is deleted}
Result<Json> Editor::SetRegion(const Json& request) {
  if (kind_ != EditedKind::kScenario) return Error{{}, "spawn regions belong to scenarios (.json)"};
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  const Result<JsonTree> read = JsonTree::Parse(text(), path());
  if (!read.ok()) return read.error();
  const JsonNode& root = read.value().root();
  const JsonNode* const list = root.Find("spawn");
  const auto rule = request.find("rule");
  const bool deletes = rule == request.end() || rule->is_null();
  if (!deletes && !rule->is_object()) return Error{{}, "found no rule, expected an object"};
  // One line, as rules are written by hand.
  const auto one_line = [](const Json& value) {
    std::vector<std::string> keys{"model", "count", "region"};
    for (const auto& [key, member] : value.items()) {
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
    std::string line = "{";
    for (const std::string& key : keys) {
      if (!value.contains(key)) continue;
      const Json& member = value.at(key);
      std::string dumped = JsonText(member);
      if (member.is_array()) {
        std::string spaced;
        for (const char c : dumped) spaced += c == ',' ? std::string(", ") : std::string(1, c);
        dumped = spaced;
      }
      line += (line.size() > 1 ? ", " : "") + Json(key).dump() + ": " + dumped;
    }
    return line + "}";
  };
  const std::optional<std::size_t> index = IndexOf(request.value("index", Json()));
  if (!index) {
    if (deletes) return Error{{}, "found no rule"};
    const std::string element = one_line(*rule);
    const std::string text_now = list != nullptr ? WithElement(text(), *list, element)
                                                 : WithMember(text(), root, "spawn", "[\n    " + element + "\n  ]");
    if (Status failure = Commit(text_now, "the new spawn region"); !failure.ok()) return failure.error();
    return Json::object();
  }
  const std::size_t at = *index;
  if (list == nullptr || at >= list->items.size()) return Error{{}, "found no spawn rule of that number"};
  if (deletes) {
    if (Status failure = Commit(WithoutItem(text(), *list, at), "the deletion of a spawn region"); !failure.ok()) {
      return failure.error();
    }
    return Json::object();
  }
  // Member by member, so that the rest of the rule stays as it is written.
  std::string changed = text();
  for (const auto& [key, member] : rule->items()) {
    const Result<JsonTree> now = JsonTree::Parse(changed, path());
    if (!now.ok()) return now.error();
    changed = WithMember(changed, now.value().root().Member("spawn").items[at], key, JsonText(member));
  }
  if (Status failure = Commit(std::move(changed), "the change of a spawn region"); !failure.ok())
    return failure.error();
  return Json::object();
}

}  // namespace troupe
