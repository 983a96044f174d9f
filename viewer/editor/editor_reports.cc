// The questions of the page: what the file has, what may be added, and what the properties and controllers are.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "robot-agent/controller/controller_table.h"
#include "viewer/editor/editor.h"
#include "viewer/editor/model_library.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/edit/written_model.h"
#include "worldfile/models/properties/color_names.h"
#include "worldfile/models/types/position_type.h"
#include "worldfile/models/types/property_table.h"
#include "worldfile/scenario/scenario_schema.h"
#include "worldfile/stage/stage_world.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxPictures = 300;  // of the palette
constexpr std::size_t kMaxWarnings = 200;  // in a reply
constexpr std::size_t kMaxEntries = 200;   // of a list of a scenario, in a reply

// Lines and columns from 1.
Json WhereJson(const SourceLocation& where) {
  return {{"file", where.file}, {"line", where.line}, {"column", where.column}};
}

// A text of JSON; null: it is none.
Json ParsedJson(std::string_view text) {
  Json value = Json::parse(text, nullptr, false);
  return value.is_discarded() ? Json() : value;
}

// [{"name", "help", "stage": its name in `ctrl`, "arguments": [...], "parameters": [...]}]
// Limits are given only where they bound the value: an infinite one is no number in JSON.
Json ControllersJson() {
  Json table = Json::array();
  for (const ControllerHelp& controller : ControllerTable()) {
    Json parameters = Json::array();
    for (const ParameterHelp& row : controller.parameters) {
      Json parameter = {{"name", row.name}, {"form", row.form},
                        {"unit", row.unit}, {"initial", ParsedJson(row.initial)},
                        {"help", row.help}, {"needed", row.needed}};
      if (std::isfinite(row.least) && row.least < row.most) parameter["least"] = row.least;
      if (std::isfinite(row.most) && row.least < row.most) parameter["most"] = row.most;
      parameters.push_back(std::move(parameter));
    }
    table.push_back({{"name", controller.name}, {"help", controller.help}, {"parameters", std::move(parameters)}});
  }
  return table;
}

// {"expand_swarm": {"name": "expand", "arguments": ["speed"]}, ...}
Json StageControllersJson() {
  Json names = Json::object();
  for (const StageControllerName& each : StageControllerNames()) {
    names[each.stage_name] = {{"name", each.name}, {"arguments", each.arguments}};
  }
  return names;
}

// {"red": [255, 0, 0], ...}
Json ColorsJson() {
  Json colors = Json::object();
  for (const NamedColor& color : NamedColors()) colors[std::string(color.name)] = {color.r, color.g, color.b};
  return colors;
}

bool IsSamePlace(const SourceLocation& a, const SourceLocation& b) {
  return a.line > 0 && a.file == b.file && a.line == b.line && a.column == b.column;
}

}  // namespace

// Constant for a version of the program; the page asks once.
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
  return Json{{"properties", std::move(table)},
              {"controllers", ControllersJson()},
              {"stage_controllers", StageControllersJson()},
              {"colors", ColorsJson()},
              {"schema", Json::parse(kScenarioSchemaText, nullptr, false)}};
}

// Asked after each edit: lists of names and places, without the text and pictures.
Result<Json> Editor::Execute(const edit::Document&) const {
  Json document = {{"file", path()},
                   {"kind", NameOf(kind_)},
                   {"modified", is_modified()},
                   {"version", version_},
                   {"error", error_ ? error_->ToString() : ""}};
  if (error_) document["error_place"] = WhereJson(error_->where);
  document["undo"] = file_.undo_label().value_or("");
  document["redo"] = file_.redo_label().value_or("");
  Json warnings = Json::array();
  Json entities = Json::array();
  Json members = Json::object();
  Json more = Json::object();
  Json properties = Json::array();
  if (world_ != nullptr) {
    const FileUnits units = UnitsOf(world_->tree.world);
    document["metres"] = units.metres;
    document["radians"] = units.radians;
    for (const Property& property : world_->tree.world.properties) {
      properties.push_back({{"name", property.name}, {"value", ToStage(property.value)}});
    }
    for (const Warning& warning : world_->loaded.warnings) {
      if (warnings.size() < kMaxWarnings) warnings.push_back(warning.ToString());
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
    for (const JsonNode& member : root.items) {
      if (!root.is_object()) break;
      members[member.key] = ToJson(member);
      if (!member.is_array() || member.items.size() <= kMaxEntries) continue;
      Json& list = members[member.key];
      list.erase(list.begin() + kMaxEntries, list.end());
      more[member.key] = member.items.size() - kMaxEntries;
    }
  }
  document["members"] = std::move(members);
  document["properties"] = std::move(properties);
  document["warnings"] = std::move(warnings);
  document["entities"] = std::move(entities);
  document["more"] = std::move(more);
  return document;
}

// A model of the file hides one of a library with the same name.
Result<Json> Editor::Execute(const edit::Palette&) const {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  Json models = Json::array();
  for (const PaletteModel& model : PaletteOf(world_->tree)) {
    Json row = {{"name", model.name},
                {"type", model.type},
                {"here", model.where.file == path()},
                {"where", WhereJson(model.where)}};
    if (models.size() < kMaxPictures) {
      const Result<LoadedWorld> alone = BuildAlone(world_->tree, model.name, files());
      if (alone.ok()) row["picture"] = PictureOf(alone.value().world);
    }
    models.push_back(std::move(row));
  }
  for (const ModelLibrary* const library : OtherLibraries()) {
    const std::string name = library->path.empty() ? "files" : std::filesystem::path(library->path).stem().string();
    for (const LibraryModel& model : library->models) {
      const bool is_hidden =
          std::any_of(models.begin(), models.end(), [&](const Json& row) { return row["name"] == model.name; });
      if (is_hidden) continue;
      models.push_back({{"name", model.name},
                        {"type", model.type},
                        {"here", false},
                        {"library", name},
                        {"where", WhereJson(model.where)},
                        {"picture", model.picture}});
    }
  }
  return Json{{"models", std::move(models)}};
}

// `own` tells the values that this entry has itself from those of macros and types, which the page shows as inherited.
Result<Json> Editor::Execute(const edit::Entity& operation) const {
  const Result<const EditedEntity*> found = FindEntity(operation.name);
  if (!found.ok()) return found.error();
  const EditedEntity& entity = *found.value();
  const Result<Place> place = PlaceOf(entity);
  Json report = {{"name", entity.name},
                 {"base_type", entity.type},
                 {"model", entity.written},
                 {"where", WhereJson(entity.where)},
                 {"shelf", entity.on_shelf}};
  report["refusal"] = place.ok() ? "" : place.error().message;
  const Pose X_WM = PoseInWorld(world_->loaded.world, entity.model);
  report["pose"] = {X_WM.x, X_WM.y, X_WM.z, X_WM.heading};
  for (const RobotDescription& robot : world_->loaded.world.robots) {
    if (robot.root != entity.model) continue;
    const bool is_own =
        place.ok() && place.value().entry != nullptr && place.value().entry->Find("controller") != nullptr;
    report["controller"] = {
        {"name", robot.controller.name}, {"parameters", ParsedJson(robot.controller.parameters)}, {"own", is_own}};
  }
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
    Json row = {{"name", property.name},
                {"value", ToStage(property.value)},
                {"own", own},
                {"where", WhereJson(property.where)}};
    for (const Warning& warning : world_->loaded.warnings) {
      const bool is_here =
          IsSamePlace(warning.where, property.where) || IsSamePlace(warning.where, property.value.where);
      if (is_here) row["warning"] = warning.message;
    }
    properties.push_back(std::move(row));
  }
  report["properties"] = std::move(properties);
  return report;
}

}  // namespace troupe
