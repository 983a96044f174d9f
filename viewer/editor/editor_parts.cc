// The requests of the page that concern the parts of a model: sensors, joints and grippers.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "viewer/editor/editor.h"
#include "viewer/editor/model_parts.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/stage/world_tree.h"
#include "worldfile/text/text_file.h"

namespace troupe {

// A part of a define in this file, with the define as built.
struct Editor::EditedPart {
  std::string model;  // name of the define
  StageTree syntax;
  BuiltDefine built;
  std::vector<ModelPart> parts;
  PartPath path;                         // empty: the define itself
  const Statement* statement = nullptr;  // its own, or the define's
  const ModelPart* part = nullptr;       // null: the define itself
};

namespace {

using Json = nlohmann::json;

// From metres to the file's unit.
std::vector<double> InUnits(std::vector<double> lengths, double metres) {
  for (double& length : lengths) length /= metres;
  return lengths;
}

// The axis is given in frame D and written in the part's own, so that it is turned back by the heading. Its length has
// no meaning, and is made 1.
Value AxisValue(const std::vector<Value::Number>& old, const std::vector<double>& axis, double heading) {
  const double length = std::hypot(axis[0], axis[1], axis[2]);
  const Vec2 xy = Transform2(Pose{0.0, 0.0, 0.0, heading}).InverseRotate({axis[0] / length, axis[1] / length});
  return ChangedTuple(old, {xy.x(), xy.y(), axis[2] / length});
}

// Names of parts are unique below their parent only.
std::string FreePartName(const std::vector<std::string>& used, const std::string& prefix) {
  std::string name = prefix;
  for (int number = 2; std::find(used.begin(), used.end(), name) != used.end(); ++number) {
    name = prefix + std::to_string(number);
  }
  return name;
}

// A number that the file gives or implies, of a property of one number.
double NumberOf(const WorldNode& node, const std::string& name, double otherwise) {
  const auto* const number = node.FindContent<Value::Number>(name);
  return number != nullptr ? number->value : otherwise;
}

// Changes the limits of a joint, and its start if that would be beyond them. In the file's unit.
Status SetLimits(StageBodyEdit& edit, const WorldNode& node, double min, double max, int decimals) {
  if (min > max) return Error{{}, "found limits in the wrong order, expected the lower one first"};
  const double least = 0.5 * std::pow(10.0, -decimals);
  const auto set = [&](const char* name, double value, double before) -> Status {
    return std::abs(value - before) < least ? Status() : edit.Set(name, Number(value, decimals));
  };
  if (Status failure = set("min_position", min, NumberOf(node, "min_position", 0.0)); !failure.ok()) return failure;
  if (Status failure = set("max_position", max, NumberOf(node, "max_position", 1.0)); !failure.ok()) return failure;
  if (node.Find("start_position") == nullptr) return {};
  const double start = NumberOf(node, "start_position", 0.0);
  return set("start_position", std::clamp(start, min, max), start);
}

}  // namespace

// A define of the file or of its includes.
Result<Json> Editor::Execute(const edit::Model& operation) const {
  const std::string& name = operation.name;
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  const auto define = world_->tree.defines.find(name);
  if (define == world_->tree.defines.end()) return Error{{}, "found no model " + Quoted(name)};
  const Result<BuiltDefine> built = BuildDefine(world_->tree, name, files());
  if (!built.ok()) return built.error();
  const WorldDescription& world = built.value().world;
  const FileUnits& units = built.value().units;
  const bool here = kind_ != EditedKind::kScenario && define->second.where.file == path();
  Json inherited = Json::object();
  for (const Property& property : built.value().node.properties) inherited[property.name] = ToStage(property.value);
  const ModelDescription& root = world.models.front();
  Json report = {{"name", name},
                 {"base", define->second.base},
                 {"base_type", built.value().node.type},
                 {"here", here},
                 {"metres", units.metres},
                 {"radians", units.radians},
                 {"where", {{"file", define->second.where.file}, {"line", define->second.where.line}}},
                 {"size", {root.size_x, root.size_y, root.size_z}},
                 {"blocks", PictureOf(world, {ModelId(0)})},
                 {"properties", std::move(inherited)},
                 {"own", Json::object()},
                 {"parts", Json::array()}};
  std::vector<ModelPart> parts;
  Result<StageTree> syntax = ParseStage(text(), path());
  if (!syntax.ok() && here) return syntax.error();
  const Statement* const statement = here ? FindDefine(syntax.value(), name) : nullptr;
  if (statement != nullptr) {
    for (const Statement& inner : statement->statements) {
      if (inner.kind == StatementKind::kProperty)
        report["own"][std::string(inner.name)] = std::string(inner.value.Of(text()));
    }
    parts = PartsOf(built.value(), *statement, path());
    report["parts"] = PartsReport(built.value(), parts, text());
  }
  report["others"] = BodiesOfOthers(built.value(), parts);
  return report;
}

// The define is parsed and built for each request: indices of an older text would name other parts.
Result<std::unique_ptr<Editor::EditedPart>> Editor::FindEditedPart(const edit::PartOperation& operation) const {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  if (kind_ == EditedKind::kScenario) return Error{{}, "a scenario has no models of its own"};
  auto edited = std::make_unique<EditedPart>();
  edited->model = operation.model;
  Result<StageTree> syntax = ParseStage(text(), path());
  if (!syntax.ok()) return syntax.error();
  edited->syntax = std::move(syntax).value();
  const Statement* const define = FindDefine(edited->syntax, edited->model);
  if (define == nullptr) return Error{{}, "found no model " + Quoted(edited->model) + " in this file"};
  Result<BuiltDefine> built = BuildDefine(world_->tree, edited->model, files());
  if (!built.ok()) return built.error();
  edited->built = std::move(built).value();
  edited->parts = PartsOf(edited->built, *define, path());
  edited->path = operation.part;
  edited->part = FindPart(edited->parts, edited->path);
  if (edited->part == nullptr && !edited->path.empty()) return Error{{}, "found no part of that number"};
  edited->statement = edited->part != nullptr ? edited->part->statement : define;
  return edited;
}

Result<Json> Editor::Execute(const edit::SetPartProperty& operation) {
  const Result<std::unique_ptr<EditedPart>> found = FindEditedPart(operation);
  if (!found.ok()) return found.error();
  const auto& [property, value] = operation.change;
  const StageBody body = BodyOf(*found.value()->statement);
  return Done(Commit(value ? WithProperty(text(), body, property, *value) : WithoutProperty(text(), body, property),
                     fmt::format("the {} of {}", property, operation.model), operation.model));
}

Result<Json> Editor::Execute(const edit::RemovePart& operation) {
  const Result<std::unique_ptr<EditedPart>> found = FindEditedPart(operation);
  if (!found.ok()) return found.error();
  if (found.value()->part == nullptr) return Error{{}, "found no part"};
  return Done(Commit(WithoutStatement(text(), *found.value()->statement),
                     "the deletion of a part of " + operation.model, operation.model));
}

Result<Json> Editor::Execute(const edit::AddPart& operation) {
  const Result<std::unique_ptr<EditedPart>> found = FindEditedPart(operation);
  if (!found.ok()) return found.error();
  const EditedPart& parent = *found.value();
  const PartShape& shape = operation.shape;
  if (parent.part != nullptr && !parent.part->model) return Error{{}, "a sensor of a ranger has no parts"};
  const FileUnits& units = parent.built.units;
  WrittenModel part{operation.type, {}, {}};
  if (!operation.prefix.empty()) {
    const WorldNode& node = parent.part != nullptr ? *parent.part->node : parent.built.node;
    part.Set("name", Text(FreePartName(ChildNames(node), operation.prefix)));
  }
  const PartPlace place = PlaceBelow(parent.built, parent.parts, parent.path);
  Pose X_DN = shape.pose.value_or(place.X_DP * Pose{0.0, 0.0, place.stack, 0.0});
  std::vector<DrawnBlock> blocks = shape.blocks;
  if (!blocks.empty()) {
    // The part's origin is at the middle of its outline.
    const BlockBounds bounds = BoundsOf(blocks);
    X_DN = {0.5 * (bounds.min_x + bounds.max_x), 0.5 * (bounds.min_y + bounds.max_y), bounds.min_z, 0.0};
    blocks = BlocksInFrame(std::move(blocks), X_DN, units.metres);
  }
  if (shape.pose || !blocks.empty()) {
    Pose X_PN = Inverse(place.X_DP) * X_DN;
    // The loader adds the height of the parent to the pose of a stacked child.
    X_PN.z -= place.stack;
    part.Set("pose", ChangedPose({}, X_PN, units));
  }
  if (!blocks.empty()) {
    FittedBody body = Fitted(blocks);
    part.Set("size", body.size);
    if (!body.is_centred) part.Set("origin", body.origin);
    if (!IsBox(blocks)) part.children = std::move(body.blocks);
  } else if (shape.size) {
    part.Set("size", Tuple(InUnits(*shape.size, units.metres)));
  }
  if (shape.axis) part.Set("axis", AxisValue({}, *shape.axis, X_DN.heading));
  if (shape.limits) {
    const std::vector<double> limits = InUnits(*shape.limits, units.metres);
    if (limits[0] != 0.0) part.Set("min_position", Number(limits[0]));
    part.Set("max_position", Number(limits[1]));
  }
  for (const auto& [name, value] : operation.properties) part.Set(name, value);
  if (operation.sensor) part.children.push_back({"sensor", *operation.sensor, {}});
  return Done(Commit(WithEntry(text(), BodyOf(*parent.statement), part),
                     fmt::format("the {} of {}", operation.type, operation.model), operation.model));
}

Result<Json> Editor::Execute(const edit::ShapePart& operation) {
  const Result<std::unique_ptr<EditedPart>> found = FindEditedPart(operation);
  if (!found.ok()) return found.error();
  const EditedPart& edited = *found.value();
  const PartShape& shape = operation.shape;
  if (edited.part == nullptr || !edited.part->model)
    return Error{{}, "found no part with a place of its own, expected one of a model"};
  if (!shape.blocks.empty()) return Error{{}, "found blocks, expected them where a part is added"};
  const FileUnits& units = edited.built.units;
  const WorldNode& node = *edited.part->node;
  const ModelDescription& model = edited.built.world.model(*edited.part->model);
  const Pose before = PoseInWorld(edited.built.world, *edited.part->model);
  const Pose X_DN = shape.pose.value_or(before);
  StageBodyEdit edit(text(), path(), edited.statement->line, edited.statement->column);
  const auto set = [&](const char* name, const Value& value) { return edit.Set(name, value); };
  if (shape.pose) {
    const PartPath above(edited.path.begin(), edited.path.end() - 1);
    const PartPlace place = PlaceBelow(edited.built, edited.parts, above);
    const std::vector<Value::Number> old = NumbersOf(node, "pose");
    Pose X_PN = Inverse(place.X_DP) * X_DN;
    X_PN.z = (old.size() == 4 ? old[2].value * units.metres : 0.0) + X_DN.z - before.z;
    if (Status failure = set("pose", ChangedPose(old, X_PN, units)); !failure.ok()) return failure.error();
  }
  if (shape.size) {
    const Value size = ChangedTuple(NumbersOf(node, "size"), InUnits(*shape.size, units.metres));
    if (Status failure = set("size", size); !failure.ok()) return failure.error();
  }
  if (shape.paddle) {
    const std::vector<double> whole = shape.size.value_or(std::vector{model.size_x, model.size_y, model.size_z});
    std::vector<double> shares;
    for (std::size_t i = 0; i < 3; ++i) shares.push_back((*shape.paddle)[i] / whole[i]);
    const Value value = ChangedTuple(NumbersOf(node, "paddle_size"), shares);
    if (Status failure = set("paddle_size", value); !failure.ok()) return failure.error();
  }
  if (shape.axis) {
    const Value axis = AxisValue(NumbersOf(node, "axis"), *shape.axis, X_DN.heading);
    if (Status failure = set("axis", axis); !failure.ok()) return failure.error();
  }
  if (shape.limits) {
    const auto* const word = node.FindContent<std::string>("type");
    const bool turns = word != nullptr && *word == "rotational";
    const double unit = turns ? units.radians : units.metres;
    const int decimals = turns ? AngleDecimals(units) : kLengthDecimals;
    Status failure = SetLimits(edit, node, (*shape.limits)[0] / unit, (*shape.limits)[1] / unit, decimals);
    if (!failure.ok()) return failure.error();
  }
  const char* const what = shape.limits || shape.axis ? "the joint" : shape.paddle ? "the paddles" : "the shape";
  return Done(Commit(edit.text(),
                     fmt::format("{} of {}", shape.is_only_pose() ? "the move of a part" : what, edited.model),
                     edited.model));
}

// The chosen parts get names where they have none.
Result<Json> Editor::Execute(const edit::SetGripperRoles& operation) {
  const Result<std::unique_ptr<EditedPart>> found = FindEditedPart(operation);
  if (!found.ok()) return found.error();
  const EditedPart& edited = *found.value();
  if (edited.part == nullptr || !edited.part->model || edited.part->node->type != "gripper")
    return Error{{}, "found no gripper, expected one"};
  struct NewName {
    const Statement* statement;
    std::string name;
  };
  std::vector<NewName> names;
  std::vector<std::pair<std::string, std::optional<std::string>>> values;
  for (const auto& [role, path_of_part] : operation.roles) {
    if (!path_of_part) {
      values.emplace_back(role, std::nullopt);
      continue;
    }
    const ModelPart* const part = FindPart(edited.parts, *path_of_part);
    if (part == nullptr || !part->model) return Error{{}, "found no part of that number for " + Quoted(role)};
    const bool is_inside = path_of_part->size() > edited.path.size() &&
                           std::equal(edited.path.begin(), edited.path.end(), path_of_part->begin());
    if (!is_inside && role != "lift") return Error{{}, "found a part outside of the gripper for " + Quoted(role)};
    const std::string& top = is_inside ? edited.part->name : edited.built.world.models.front().name;
    if (!part->name.starts_with(top + ".")) return Error{{}, "found a part with a full name, expected a plain one"};
    std::string name = part->name.substr(top.size() + 1);
    if (part->node->Find("name") == nullptr) {
      const PartPath above(path_of_part->begin(), path_of_part->end() - 1);
      const ModelPart* const parent = FindPart(edited.parts, above);
      std::vector<std::string> used =
          ChildNames(parent != nullptr && parent->node != nullptr ? *parent->node : edited.built.node);
      const auto known = std::find_if(names.begin(), names.end(),
                                      [&](const NewName& each) { return each.statement == part->statement; });
      for (const NewName& each : names) used.push_back(each.name);
      const std::size_t dot = name.rfind('.');
      const std::string own = known != names.end() ? known->name : FreePartName(used, role);
      name.resize(dot != std::string::npos ? dot + 1 : 0);
      name += own;
      if (known == names.end()) names.push_back({part->statement, own});
    }
    values.emplace_back(role, std::move(name));
  }
  // From the last statement to the first, so that none moves before its turn.
  const auto is_later = [](const NewName& a, const NewName& b) {
    return a.statement->span.begin > b.statement->span.begin;
  };
  std::sort(names.begin(), names.end(), is_later);
  std::string changed = text();
  const auto set_names = [&](auto applies) -> Status {
    for (const NewName& each : names) {
      if (!applies(each.statement->span.begin)) continue;
      StageBodyEdit edit(changed, path(), each.statement->line, each.statement->column);
      if (Status failure = edit.Set("name", Text(each.name)); !failure.ok()) return failure;
      changed = edit.text();
    }
    return {};
  };
  const std::size_t at = edited.statement->span.begin;
  if (Status failure = set_names([&](std::size_t begin) { return begin > at; }); !failure.ok()) return failure.error();
  StageBodyEdit edit(changed, path(), edited.statement->line, edited.statement->column);
  for (const auto& [role, name] : values) {
    Status failure = name ? edit.Set(role, Text(*name)) : edit.Remove(role);
    if (!failure.ok()) return failure.error();
  }
  changed = edit.text();
  if (Status failure = set_names([&](std::size_t begin) { return begin < at; }); !failure.ok()) return failure.error();
  return Done(Commit(std::move(changed), "the fingers of " + edited.part->name, edited.model));
}

}  // namespace troupe
