// The requests of the page that concern models: walls and rooms, and the defines of the model editor.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "common/worldfile/edit/stage_edit.h"
#include "common/worldfile/stage/stage_parser.h"
#include "common/worldfile/text/quote.h"
#include "viewer/editor/editor.h"
#include "viewer/editor/editor_place.h"
#include "viewer/editor/model_picture.h"
#include "viewer/editor/property_text.h"
#include "viewer/editor/request_values.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostProperties = 100;  // of a request

// The box around drawn blocks, in the file's units.
struct Bounds {
  double min_x = std::numeric_limits<double>::max();
  double min_y = std::numeric_limits<double>::max();
  double min_z = std::numeric_limits<double>::max();
  double max_x = std::numeric_limits<double>::lowest();
  double max_y = std::numeric_limits<double>::lowest();
  double max_z = std::numeric_limits<double>::lowest();
};

Bounds BoundsOf(const std::vector<DrawnBlock>& blocks) {
  Bounds bounds;
  for (const DrawnBlock& block : blocks) {
    for (const Vec2& corner : block.outline) {
      bounds.min_x = std::min(bounds.min_x, corner.x());
      bounds.max_x = std::max(bounds.max_x, corner.x());
      bounds.min_y = std::min(bounds.min_y, corner.y());
      bounds.max_y = std::max(bounds.max_y, corner.y());
    }
    bounds.min_z = std::min(bounds.min_z, block.z_min);
    bounds.max_z = std::max(bounds.max_z, block.z_max);
  }
  return bounds;
}

// Blocks are fitted to the model's size and centred on its origin: with the size of their own box, and the origin at
// the middle of it, they are where they were drawn.
struct FittedBody {
  WrittenValue size;
  WrittenValue origin;
  bool is_centred = false;
  std::vector<WrittenModel> blocks;
};

FittedBody Fitted(const std::vector<DrawnBlock>& blocks) {
  const Bounds bounds = BoundsOf(blocks);
  const double x = 0.5 * (bounds.min_x + bounds.max_x);
  const double y = 0.5 * (bounds.min_y + bounds.max_y);
  FittedBody body{Tuple({bounds.max_x - bounds.min_x, bounds.max_y - bounds.min_y, bounds.max_z - bounds.min_z}),
                  Tuple({x, y, 0.0, 0.0}, 5),
                  std::abs(x) < 1e-5 && std::abs(y) < 1e-5,
                  {}};
  for (const DrawnBlock& block : blocks) {
    body.blocks.push_back(WrittenBlock(block.outline, block.z_min, block.z_max));
  }
  return body;
}

// "properties": {"color": "\"red\"", ...}, values as text of a world file.
Result<std::vector<std::pair<std::string, WrittenValue>>> PropertiesIn(const Json& request) {
  std::vector<std::pair<std::string, WrittenValue>> properties;
  const auto given = request.find("properties");
  if (given == request.end()) return properties;
  if (!given->is_object() || given->size() > kMostProperties) return Error{{}, "found no object of properties"};
  for (const auto& [name, text] : given->items()) {
    if (!IsPropertyName(name) || !text.is_string())
      return Error{{}, "found the property " + Quoted(name) + ", expected a text"};
    Result<WrittenValue> value = ReadValueText(text.get<std::string>());
    if (!value.ok()) return Error{{}, Quoted(name) + ": " + value.error().message};
    properties.emplace_back(name, std::move(value).value());
  }
  return properties;
}

bool IsWord(const std::string& text) {
  return IsPropertyName(text) && text.find('[') == std::string::npos;
}

// The entries of a body but for its blocks, with their properties as text.
Json PartsOf(const std::string& text, const std::vector<Statement>& statements, int depth) {
  Json parts = Json::array();
  int index = 0;
  for (const Statement& statement : statements) {
    if (statement.kind != StatementKind::kEntry || statement.name == "block") continue;
    Json properties = Json::object();
    for (const Statement& inner : statement.statements) {
      if (inner.kind == StatementKind::kProperty) properties[inner.name] = std::string(inner.value.Of(text));
    }
    Json part = {{"index", index++}, {"type", statement.name}, {"line", statement.line}, {"properties", properties}};
    if (depth < 8) part["parts"] = PartsOf(text, statement.statements, depth + 1);
    parts.push_back(std::move(part));
  }
  return parts;
}

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
  const DrawnBlock& first = blocks.value().front();
  const auto is_box = [&] {
    if (blocks.value().size() != 1 || first.outline.size() != 4 || first.z_min != 0.0) return false;
    const Bounds bounds = BoundsOf(blocks.value());
    return std::all_of(first.outline.begin(), first.outline.end(), [&](const Vec2& corner) {
      return (corner.x() == bounds.min_x || corner.x() == bounds.max_x) &&
             (corner.y() == bounds.min_y || corner.y() == bounds.max_y);
    });
  };
  if (!is_box()) model.children = std::move(body.blocks);
  if (Status failure = AddWritten(model, "the addition of " + name); !failure.ok()) return failure.error();
  return Json{{"name", name}};
}

// A define of the file or of its includes.
Result<Json> Editor::ModelReport(const std::string& name) const {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  const auto define = world_->tree.defines.find(name);
  if (define == world_->tree.defines.end()) return Error{{}, "found no model " + Quoted(name)};
  const Result<LoadedWorld> alone = BuildAlone(world_->tree, name, allowed_);
  if (!alone.ok()) return alone.error();
  const WorldDescription& world = alone.value().world;
  const FileUnits units = UnitsOf(world_->tree);
  const bool here = kind_ != EditedKind::kScenario && define->second.where.file == path();
  Json report = {{"name", name},
                 {"base", define->second.base},
                 {"here", here},
                 {"metres", units.metres},
                 {"radians", units.radians},
                 {"where", {{"file", define->second.where.file}, {"line", define->second.where.line}}}};
  const ModelDescription& root = world.models.front();
  WorldDescription only_root = world;
  only_root.models = {root};
  report["blocks"] = PictureOf(only_root);
  report["picture"] = PictureOf(world);
  const Result<WorldNode> node = Instantiate(world_->tree, name, {});
  Json inherited = Json::object();
  if (node.ok()) {
    report["type"] = node.value().type;
    for (const Property& property : node.value().properties) inherited[property.name] = ValueText(property.value);
  }
  report["properties"] = std::move(inherited);
  report["own"] = Json::object();
  report["parts"] = Json::array();
  if (!here) return report;
  const Result<StageSyntax> syntax = ReadStageSyntax(text(), path());
  if (!syntax.ok()) return syntax.error();
  const Statement* const statement = FindDefine(syntax.value(), name);
  if (statement == nullptr) return report;
  for (const Statement& inner : statement->statements) {
    if (inner.kind == StatementKind::kProperty) report["own"][inner.name] = std::string(inner.value.Of(text()));
  }
  report["parts"] = PartsOf(text(), statement->statements, 0);
  return report;
}

// {"name", "base": of a new one, "blocks": ..., "properties": {...}, "remove": [names]}
Result<Json> Editor::SetModel(const Json& request) {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  if (kind_ == EditedKind::kScenario) {
    return Error{{}, "a scenario has no models of its own: edit the .inc or .world file that it names"};
  }
  const std::string name = TextIn(request, "name");
  if (!IsWord(name))
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
  const Result<StageSyntax> syntax = ReadStageSyntax(text(), path());
  if (!syntax.ok()) return syntax.error();
  const auto known = world_->tree.defines.find(name);
  if (const std::string base = TextIn(request, "base"); !base.empty()) {
    if (known != world_->tree.defines.end())
      return Error{{}, "found the model " + Quoted(name) + " in use, expected another name"};
    if (!IsWord(base)) return Error{{}, "found the base " + Quoted(base) + ", expected a model"};
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
  std::string changed = text();
  const auto with = [&](const std::string& property, const WrittenValue& value) -> Status {
    const Result<StageSyntax> now = ReadStageSyntax(changed, path());
    if (!now.ok()) return now.error();
    changed = WithProperty(changed, BodyOf(*FindDefine(now.value(), name)), property, value);
    return {};
  };
  if (!drawn.empty()) {
    FittedBody body = Fitted(drawn);
    if (Status failure = with("size", body.size); !failure.ok()) return failure.error();
    const Result<WorldNode> node = Instantiate(world_->tree, name, {});
    const bool has_origin = node.ok() && node.value().Find("origin") != nullptr;
    if (!body.is_centred || has_origin) {
      if (Status failure = with("origin", body.origin); !failure.ok()) return failure.error();
    }
    Result<std::string> blocks = WithBlocks(changed, path(), name, body.blocks);
    if (!blocks.ok()) return blocks.error();
    changed = std::move(blocks).value();
  }
  for (const auto& [property, value] : properties.value()) {
    if (Status failure = with(property, value); !failure.ok()) return failure.error();
  }
  if (const auto removed = request.find("remove"); removed != request.end() && removed->is_array()) {
    for (const Json& property : *removed) {
      if (!property.is_string()) continue;
      const Result<StageSyntax> now = ReadStageSyntax(changed, path());
      if (!now.ok()) return now.error();
      changed = WithoutProperty(changed, BodyOf(*FindDefine(now.value(), name)), property.get<std::string>());
    }
  }
  if (Status failure = Commit(std::move(changed), "the change of model " + name, name); !failure.ok()) {
    return failure.error();
  }
  return Json::object();
}

Result<Editor::Place> Editor::PlaceOfPart(const Json& request) const {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  const std::string name = TextIn(request, "model");
  Place place;
  if (kind_ == EditedKind::kScenario) return Error{{}, "a scenario has no models of its own"};
  Result<StageSyntax> syntax = ReadStageSyntax(text(), path());
  if (!syntax.ok()) return syntax.error();
  place.stage = std::make_unique<StageSyntax>(std::move(syntax).value());
  place.statement = FindDefine(*place.stage, name);
  if (place.statement == nullptr) return Error{{}, "found no model " + Quoted(name) + " in this file"};
  const auto path_of_part = request.find("part");
  if (path_of_part == request.end() || !path_of_part->is_array()) return place;
  for (const Json& step : *path_of_part) {
    const std::optional<std::size_t> index = IndexOf(step);
    if (!index) return Error{{}, "found no part of that number"};
    std::size_t left = *index;
    const Statement* next = nullptr;
    for (const Statement& statement : place.statement->statements) {
      if (statement.kind != StatementKind::kEntry || statement.name == "block") continue;
      if (left-- == 0) {
        next = &statement;
        break;
      }
    }
    if (next == nullptr) return Error{{}, "found no part of that number"};
    place.statement = next;
  }
  return place;
}

// {"model", "part": [indices], "action": "set", "property", "value": text or null}
// {"model", "part": of the parent, "action": "add", "kind": type, "properties": {...}, "sensor": {...}}
// {"model", "part", "action": "remove"}
Result<Json> Editor::ChangePart(const Json& request) {
  const Result<Place> found = PlaceOfPart(request);
  if (!found.ok()) return found.error();
  const Place& place = found.value();
  const std::string name = TextIn(request, "model");
  const std::string action = TextIn(request, "action");
  Status status;
  if (action == "remove") {
    if (place.statement->kind == StatementKind::kDefine) return Error{{}, "found no part"};
    status = Commit(WithoutStatement(text(), *place.statement), "the deletion of a part of " + name, name);
  } else if (action == "add") {
    const std::string type = TextIn(request, "kind");
    if (!IsWord(type)) return Error{{}, "found the part " + Quoted(type) + ", expected a type of model"};
    Result<std::vector<std::pair<std::string, WrittenValue>>> properties = PropertiesIn(request);
    if (!properties.ok()) return properties.error();
    WrittenModel part{type, std::move(properties).value(), {}};
    if (const auto sensor = request.find("sensor"); sensor != request.end() && sensor->is_object()) {
      Result<std::vector<std::pair<std::string, WrittenValue>>> of_sensor = PropertiesIn({{"properties", *sensor}});
      if (!of_sensor.ok()) return of_sensor.error();
      part.children.push_back({"sensor", std::move(of_sensor).value(), {}});
    }
    status = Commit(WithEntry(text(), BodyOf(*place.statement), part), fmt::format("the {} of {}", type, name), name);
  } else if (action == "set") {
    const Result<PropertyChange> change = PropertyChangeIn(request);
    if (!change.ok()) return change.error();
    const auto& [property, value] = change.value();
    status = SetBody(place, property, value, fmt::format("the {} of {}", property, name));
  } else {
    return Error{{}, "found the action " + Quoted(action) + ", expected set, add or remove"};
  }
  if (!status.ok()) return status.error();
  return Json::object();
}

}  // namespace troupe
