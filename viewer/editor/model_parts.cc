#include "viewer/editor/model_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "worldfile/stage/stage_world.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr int kMaxDepth = 8;

// Joins the entries of the text with the nodes of the built define, by line and column: names may be missing or
// repeated.
class PartFinder {
 public:
  PartFinder(const BuiltDefine& built, const std::string& path) : path_(path) {
    for (std::size_t i = 0; i < built.world.models.size(); ++i) models_.emplace(built.world.models[i].name, ModelId(i));
  }

  std::vector<ModelPart> Find(const Statement& holder, const WorldNode* node, const std::string& name,
                              const PartPath& path) const {
    const std::vector<std::string> given = node != nullptr ? ChildNames(*node) : std::vector<std::string>();
    std::vector<ModelPart> parts;
    for (const Statement& statement : holder.statements) {
      if (statement.kind != StatementKind::kEntry || statement.name == "block") continue;
      ModelPart part;
      part.path = path;
      part.path.push_back(parts.size());
      part.statement = &statement;
      for (std::size_t i = 0; i < given.size(); ++i) {
        const WorldNode& child = node->children[i];
        const SourceLocation& where = child.where;
        if (where.file != path_ || where.line != statement.line || where.column != statement.column) continue;
        part.node = &child;
        if (given[i].empty()) break;
        part.name = FullName(name, given[i]);
        if (const auto found = models_.find(part.name); found != models_.end()) part.model = found->second;
      }
      if (part.path.size() <= kMaxDepth) part.parts = Find(statement, part.node, part.name, part.path);
      parts.push_back(std::move(part));
    }
    return parts;
  }

 private:
  const std::string& path_;
  std::map<std::string, ModelId> models_;
};

void AddListed(const std::vector<ModelPart>& parts, std::map<ModelId, const ModelPart*>& listed) {
  for (const ModelPart& part : parts) {
    if (part.model) listed.emplace(*part.model, &part);
    AddListed(part.parts, listed);
  }
}

// The listed part that a model belongs to: itself or its nearest ancestor; null: none.
// A body that a type implies, as the paddles of a gripper, is drawn with the part that has it.
const ModelPart* OwnerOf(const BuiltDefine& built, const std::map<ModelId, const ModelPart*>& listed, ModelId id) {
  for (std::optional<ModelId> at = id; at; at = built.world.model(*at).parent) {
    if (const auto found = listed.find(*at); found != listed.end()) return found->second;
  }
  return nullptr;
}

Json PoseJson(const Pose& pose) {
  return {pose.x, pose.y, pose.z, pose.heading};
}

const JointDescription* JointOf(const BuiltDefine& built, ModelId model) {
  for (const JointDescription& joint : built.world.joints) {
    if (joint.model == model) return &joint;
  }
  return nullptr;
}

Json JointJson(const JointDescription& joint, const Pose& X_DN) {
  const Vec2 axis = Transform2(X_DN).Rotate(joint.axis_xy);
  return {{"type", StageWordOf(joint.type)},
          {"axis", {axis.x(), axis.y(), joint.axis_z}},
          {"limits", {joint.position.min, joint.position.max}},
          {"max_speed", joint.max_speed}};
}

// The report is one pass over the parts, with the bodies sorted by their owners before.
class PartReporter {
 public:
  PartReporter(const BuiltDefine& built, const std::vector<ModelPart>& parts, const std::string& text)
      : built_(built), text_(text) {
    AddListed(parts, listed_);
    for (std::size_t i = 0; i < built.world.models.size(); ++i) {
      if (const ModelPart* const owner = OwnerOf(built, listed_, ModelId(i))) bodies_[owner].emplace_back(i);
    }
  }

  Json Report(const std::vector<ModelPart>& parts) const {
    Json list = Json::array();
    for (const ModelPart& part : parts) {
      Json properties = Json::object();
      for (const Statement& inner : part.statement->statements) {
        if (inner.kind == StatementKind::kProperty)
          properties[std::string(inner.name)] = std::string(inner.value.Of(text_));
      }
      Json row = {{"index", part.path.back()},
                  {"type", part.statement->name},
                  {"line", part.statement->line},
                  {"properties", std::move(properties)},
                  {"parts", Report(part.parts)}};
      if (part.model) AddModel(part, row);
      list.push_back(std::move(row));
    }
    return list;
  }

 private:
  void AddModel(const ModelPart& part, Json& row) const {
    const ModelDescription& model = built_.world.model(*part.model);
    const Pose X_DN = PoseInWorld(built_.world, *part.model);
    row["model"] = part.node->type;
    row["name"] = part.name.substr(std::min(part.name.size(), built_.world.models.front().name.size() + 1));
    row["pose"] = PoseJson(X_DN);
    row["body"] = PoseJson(X_DN * OriginOf(*part.node, built_.units));
    row["size"] = {model.size_x, model.size_y, model.size_z};
    const Shape& shape = built_.world.shape(model.shape);
    const bool has_blocks = std::any_of(part.node->children.begin(), part.node->children.end(),
                                        [](const WorldNode& child) { return child.type == "block"; });
    const bool is_gripper = part.node->type == "gripper";
    row["is_box"] = !has_blocks && !is_gripper && shape.blocks.size() == 1 && shape.rectangles.empty();
    row["bodies"] = PictureOf(built_.world, bodies_.at(listed_.at(*part.model)));
    if (const JointDescription* const joint = JointOf(built_, *part.model)) row["joint"] = JointJson(*joint, X_DN);
    if (is_gripper) row["gripper"] = GripperJson(part);
  }

  Json GripperJson(const ModelPart& part) const {
    Json report = Json::object();
    for (const GripperDescription& gripper : built_.world.grippers) {
      if (built_.world.robot(gripper.robot).name + "." + gripper.name != part.name) continue;
      const ModelId left = built_.world.joint(gripper.left).model;
      if (!listed_.contains(left)) {
        const ModelDescription& paddle = built_.world.model(left);
        if (part.node->Find("left_finger") == nullptr) {
          report["paddle"] = {paddle.size_x, paddle.size_y, paddle.size_z};
        }
        if (part.node->Find("lift") != nullptr) AddRole("lift", gripper.lift, report);
        continue;
      }
      AddRole("left_finger", gripper.left, report);
      AddRole("right_finger", gripper.right, report);
      AddRole("lift", gripper.lift, report);
      for (const auto& [role, pad] : {std::pair("left_pad", gripper.left_pad), {"right_pad", gripper.right_pad}}) {
        const auto found = listed_.find(pad);
        if (found != listed_.end() && part.node->Find(role) != nullptr) report[role] = found->second->path;
      }
    }
    return report;
  }

  void AddRole(const char* role, const std::optional<JointId>& joint, Json& report) const {
    if (!joint) return;
    const auto found = listed_.find(built_.world.joint(*joint).model);
    if (found != listed_.end()) report[role] = found->second->path;
  }

  const BuiltDefine& built_;
  const std::string& text_;
  std::map<ModelId, const ModelPart*> listed_;
  std::map<const ModelPart*, std::vector<ModelId>> bodies_;
};

// The old number keeps its text, "0.10" for instance.
Value::Number ChangedNumber(const Value::Number* old, double number, double change, int decimals) {
  const bool is_same = old != nullptr && std::abs(change) < 0.5 * std::pow(10.0, -decimals);
  return is_same ? *old : RoundedNumber(number, decimals);
}

}  // namespace

Result<BuiltDefine> BuildDefine(const WorldTree& tree, const std::string& name, const NamedFiles& files) {
  Result<LoadedWorld> alone = BuildAlone(tree, name, files);
  if (!alone.ok()) return alone.error();
  Result<WorldNode> node = Instantiate(tree, name, {});
  if (!node.ok()) return node.error();
  return BuiltDefine{std::move(node).value(), std::move(alone.value().world), UnitsOf(tree.world)};
}

std::vector<ModelPart> PartsOf(const BuiltDefine& built, const Statement& define, const std::string& path) {
  return PartFinder(built, path).Find(define, &built.node, built.world.models.front().name, {});
}

const ModelPart* FindPart(const std::vector<ModelPart>& parts, const PartPath& path) {
  const std::vector<ModelPart>* list = &parts;
  const ModelPart* found = nullptr;
  for (const std::size_t index : path) {
    if (index >= list->size()) return nullptr;
    found = &(*list)[index];
    list = &found->parts;
  }
  return found;
}

// stack_children is on unless the model says 0.
PartPlace PlaceBelow(const BuiltDefine& built, const std::vector<ModelPart>& parts, const PartPath& path) {
  const ModelPart* const parent = FindPart(parts, path);
  const WorldNode* const node = parent != nullptr ? parent->node : &built.node;
  const ModelId model = parent != nullptr ? parent->model.value_or(ModelId(0)) : ModelId(0);
  const auto* const flag = node != nullptr ? node->FindContent<Value::Number>("stack_children") : nullptr;
  const bool on_top = flag == nullptr || flag->value != 0.0;
  return {PoseInWorld(built.world, model), on_top ? built.world.model(model).size_z : 0.0};
}

Json PartsReport(const BuiltDefine& built, const std::vector<ModelPart>& parts, const std::string& text) {
  return PartReporter(built, parts, text).Report(parts);
}

Json BodiesOfOthers(const BuiltDefine& built, const std::vector<ModelPart>& parts) {
  std::map<ModelId, const ModelPart*> listed;
  AddListed(parts, listed);
  std::vector<ModelId> others;
  for (std::size_t i = 1; i < built.world.models.size(); ++i) {
    if (OwnerOf(built, listed, ModelId(i)) == nullptr) others.emplace_back(i);
  }
  return PictureOf(built.world, others);
}

double WrappedDegrees(double degrees) {
  degrees = std::remainder(degrees, 360.0);
  return degrees <= -180.0 ? degrees + 360.0 : degrees;
}

std::vector<Value::Number> NumbersOf(const WorldNode& node, const std::string& name) {
  std::vector<Value::Number> numbers;
  const auto* const tuple = node.FindContent<Value::Tuple>(name);
  for (std::size_t i = 0; tuple != nullptr && i < tuple->size(); ++i) {
    const auto* const number = std::get_if<Value::Number>(&(*tuple)[i]);
    numbers.push_back(number != nullptr ? *number : Value::Number{0.0, "0"});
  }
  return numbers;
}

Pose OriginOf(const WorldNode& node, const FileUnits& units) {
  const std::vector<Value::Number> numbers = NumbersOf(node, "origin");
  if (numbers.size() != 4) return {};
  return {numbers[0].value * units.metres, numbers[1].value * units.metres, numbers[2].value * units.metres,
          numbers[3].value * units.radians};
}

Value ChangedTuple(const std::vector<Value::Number>& old, const std::vector<double>& numbers, int decimals) {
  Value::Tuple tuple;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Value::Number* const before = i < old.size() ? &old[i] : nullptr;
    const double change = before != nullptr ? numbers[i] - before->value : 0.0;
    tuple.emplace_back(ChangedNumber(before, numbers[i], change, decimals));
  }
  return {std::move(tuple), {}};
}

// Headings are compared as angles: 359.999 and -0.001 are the same.
Value ChangedPose(std::vector<Value::Number> old, const Pose& pose, const FileUnits& units) {
  old.resize(4, Value::Number{0.0, "0"});
  const bool in_radians = units.radians == 1.0;
  const double turn = in_radians ? 2.0 * std::numbers::pi : 360.0;
  const double heading = in_radians ? pose.heading : WrappedDegrees(AngleInFile(pose.heading, units));
  Value::Tuple tuple;
  const double lengths[] = {pose.x / units.metres, pose.y / units.metres, pose.z / units.metres};
  for (std::size_t i = 0; i < 3; ++i) {
    tuple.emplace_back(ChangedNumber(&old[i], lengths[i], lengths[i] - old[i].value, kLengthDecimals));
  }
  const double change = std::remainder(heading - old[3].value, turn);
  tuple.emplace_back(ChangedNumber(&old[3], heading, change, AngleDecimals(units)));
  return {std::move(tuple), {}};
}

double AngleInFile(double angle, const FileUnits& units) {
  return angle / units.radians;
}

int AngleDecimals(const FileUnits& units) {
  return units.radians == 1.0 ? kRadianDecimals : kHeadingDecimals;
}

std::vector<DrawnBlock> BlocksInFrame(std::vector<DrawnBlock> blocks, const Pose& X_DF, double metres) {
  const Transform2 transform(X_DF);
  for (DrawnBlock& block : blocks) {
    for (Vec2& corner : block.outline) corner = transform.InverseTransform(corner) / metres;
    block.z_min = (block.z_min - X_DF.z) / metres;
    block.z_max = (block.z_max - X_DF.z) / metres;
  }
  return blocks;
}

BlockBounds BoundsOf(const std::vector<DrawnBlock>& blocks) {
  BlockBounds bounds;
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

FittedBody Fitted(const std::vector<DrawnBlock>& blocks) {
  const BlockBounds bounds = BoundsOf(blocks);
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

// Exact comparisons: the page makes the corners of a box from its sides.
bool IsBox(const std::vector<DrawnBlock>& blocks) {
  if (blocks.size() != 1 || blocks[0].outline.size() != 4 || blocks[0].z_min != 0.0) return false;
  const BlockBounds bounds = BoundsOf(blocks);
  return std::all_of(blocks[0].outline.begin(), blocks[0].outline.end(), [&](const Vec2& corner) {
    return (corner.x() == bounds.min_x || corner.x() == bounds.max_x) &&
           (corner.y() == bounds.min_y || corner.y() == bounds.max_y);
  });
}

}  // namespace troupe
