// The edits that only scenarios have: values by their paths, robots and models of the scenario's world.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "viewer/editor/editor.h"
#include "viewer/editor/model_parts.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

}  // namespace

Result<Editor::Place> Editor::PlaceOfScenario() const {
  Result<JsonTree> json = JsonTree::Parse(text(), path());
  if (!json.ok()) return json.error();
  Place place;
  place.text = text();
  place.json = std::make_unique<JsonTree>(std::move(json).value());
  place.entry = &place.json->root();
  return place;
}

bool Editor::IsRobotOfWorld(const EditedEntity& entity) const {
  return kind_ == EditedKind::kScenario && entity.type == "position" && entity.parent == nullptr &&
         entity.where.file != path();
}

// An entry of `robots` without a model changes the robot of that name.
Result<Editor::Place> Editor::PlaceOfRobotOfWorld(const EditedEntity& entity) const {
  Result<Place> scenario = PlaceOfScenario();
  if (!scenario.ok()) return scenario;
  const JsonNode& root = scenario.value().json->root();
  const JsonNode* robots = root.Find("robots");
  const auto is_called = [&](const JsonNode& entry) {
    const JsonNode* const name = entry.Find("name");
    return name != nullptr && name->text == entity.name;
  };
  const auto find_entry = [&](const JsonNode& list) -> const JsonNode* {
    const auto found = std::find_if(list.items.begin(), list.items.end(), is_called);
    return found != list.items.end() ? &*found : nullptr;
  };
  Place place = std::move(scenario).value();
  if (robots == nullptr || find_entry(*robots) == nullptr) {
    const std::size_t count = robots != nullptr ? robots->items.size() : 0;
    Result<std::string> extended = WithValueAt(place.text, root, {"robots", count, "name"}, Json(entity.name).dump());
    if (!extended.ok()) return extended.error();
    place.text = std::move(extended).value();
    Result<JsonTree> read = JsonTree::Parse(place.text, path());
    if (!read.ok()) return read.error();
    place.json = std::make_unique<JsonTree>(std::move(read).value());
    robots = place.json->root().Find("robots");
  }
  place.holder = robots;
  place.entry = find_entry(*robots);
  return place;
}

// What has no entry of its own in the file, which could be deleted.
bool Editor::IsLeftOut(const EditedEntity& entity) const {
  if (entity.parent != nullptr) return false;
  if (entity.where.file != path()) return true;
  const Result<Place> scenario = PlaceOfScenario();
  if (!scenario.ok()) return false;
  const auto chain = scenario.value().json->PathTo(scenario.value().json->OffsetOf(entity.where));
  return std::any_of(chain.begin(), chain.end(), [](const JsonNode* node) { return node->key == "spawn"; });
}

Status Editor::LeaveOut(const std::string& name) {
  const Result<Place> scenario = PlaceOfScenario();
  if (!scenario.ok()) return scenario.error();
  const JsonNode& root = *scenario.value().entry;
  const std::size_t count = root.ItemsOf("without").size();
  Result<std::string> changed = WithValueAt(text(), root, {"without", count}, Json(name).dump());
  if (!changed.ok()) return changed.error();
  return Commit(std::move(changed).value(), "the deletion of " + name);
}

// Scenarios are in metres and degrees, whatever the units of their world.
Status Editor::SetScenarioPose(const EditedEntity& entity, const Pose& pose) {
  const std::string label = "the move of " + entity.name;
  const double degrees = WrappedDegrees(pose.heading * 180.0 / std::numbers::pi);
  const auto number = [](double value, int decimals) { return PlainNumber(value, decimals); };
  const std::string x = number(pose.x, kLengthDecimals);
  const std::string y = number(pose.y, kLengthDecimals);
  const std::string z = number(pose.z, kLengthDecimals);
  const std::string heading = number(degrees, kHeadingDecimals);
  const std::string flat = fmt::format("[{}, {}, {}]", x, y, heading);
  const std::string raised = fmt::format("[{}, {}, {}, {}]", x, y, z, heading);
  const Pose before = PoseInWorld(world_->loaded.world, entity.model);
  // Less than half of the last written digit is no change of the height.
  const bool keeps_z = std::abs(pose.z - before.z) < 0.5 * std::pow(10.0, -kLengthDecimals);
  if (entity.where.file == path()) {
    const Result<Place> place = PlaceOf(entity);
    if (!place.ok()) return place.error();
    if (entity.parent != nullptr) return Error{{}, "a child of a scenario's model is moved by its properties"};
    const JsonNode* const old = place.value().entry->Find("pose");
    const bool is_raised = (old != nullptr && old->items.size() == 4) || !keeps_z;
    return Commit(WithMember(text(), *place.value().entry, "pose", is_raised ? raised : flat), label);
  }
  // A model of the world file: the scenario moves it.
  if (entity.parent != nullptr) {
    return Error{
        {}, fmt::format("{} is a part of a model at {}:{}", Quoted(entity.name), entity.where.file, entity.where.line)};
  }
  const Result<JsonTree> read = JsonTree::Parse(text(), path());
  if (!read.ok()) return read.error();
  const JsonNode& root = read.value().root();
  const auto is_called = [&](const JsonNode* value) { return value != nullptr && value->text == entity.name; };
  const std::string name = nlohmann::json(entity.name).dump();
  if (entity.type == "position") {
    if (const JsonNode* const robots = root.Find("robots")) {
      for (const JsonNode& robot : robots->items) {
        if (is_called(robot.Find("name")))
          return Commit(WithMember(text(), robot, "pose", keeps_z ? flat : raised), label);
      }
      return Commit(WithElement(text(), *robots, fmt::format("{{\"name\": {}, \"pose\": {}}}", name, flat)), label);
    }
    return Commit(WithMember(text(), root, "robots", fmt::format("[{{\"name\": {}, \"pose\": {}}}]", name, flat)),
                  label);
  }
  const FileUnits units = UnitsOf(world_->tree.world);
  const double factor = 1.0 / units.metres;
  std::vector<Value::Number> old = NumbersOf(*entity.node, "pose");
  old.resize(4, Value::Number{0.0, "0"});
  const std::string in_file = fmt::format("[{}, {}, {}, {}]", number(pose.x * factor, kLengthDecimals),
                                          number(pose.y * factor, kLengthDecimals),
                                          number(old[2].value + (pose.z - before.z) * factor, kLengthDecimals),
                                          units.radians == 1.0 ? number(pose.heading, kRadianDecimals) : heading);
  if (const JsonNode* const overrides = root.Find("override")) {
    for (const JsonNode& rule : overrides->items) {
      const JsonNode* const match = rule.Find("match");
      const JsonNode* const properties = rule.Find("properties");
      if (match == nullptr || properties == nullptr || match->items.size() != 1 || !is_called(match->Find("name")))
        continue;
      return Commit(WithMember(text(), *properties, "pose", in_file), label);
    }
  }
  const std::string rule = fmt::format(R"({{"match": {{"name": {}}}, "properties": {{"pose": {}}}}})", name, in_file);
  if (const JsonNode* const overrides = root.Find("override"))
    return Commit(WithElement(text(), *overrides, rule), label);
  return Commit(WithMember(text(), root, "override", "[" + rule + "]"), label);
}

// The syntax is parsed again, as `text` may be another one than the file's.
Result<std::string> Editor::WithAdded(const std::string& text, const WrittenModel& model, bool is_robot) const {
  if (kind_ != EditedKind::kScenario) {
    const Result<StageTree> syntax = ParseStage(text, path());
    if (!syntax.ok()) return syntax.error();
    return WithEntry(text, syntax.value().body(), model);
  }
  const Result<JsonTree> read = JsonTree::Parse(text, path());
  if (!read.ok()) return read.error();
  const JsonNode& root = read.value().root();
  const char* const list = is_robot ? "robots" : "models";
  const std::string entry = ToScenarioEntry(model);
  if (const JsonNode* const holder = root.Find(list)) return WithElement(text, *holder, entry);
  return WithMember(text, root, list, "[\n    " + entry + "\n  ]");
}

// The objects and lists on the path that exist are kept with their members.
Result<Json> Editor::Execute(const edit::SetValue& operation) {
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
  Result<std::string> changed = WithValueAt(place.value().text, *place.value().entry, operation.path, operation.value);
  if (!changed.ok()) return changed.error();
  std::string what;
  for (const auto& step : operation.path) {
    if (const auto* const key = std::get_if<std::string>(&step)) what = *key;
  }
  return Done(Commit(std::move(changed).value(), "the change of " + what));
}

}  // namespace troupe
