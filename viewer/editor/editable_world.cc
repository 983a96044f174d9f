#include "viewer/editor/editable_world.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "robot-agent/controller/create_controller.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/models/build_world.h"
#include "worldfile/scenario/scenario.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr double kShelfGap = 0.6;  // m

bool HasOwnPlace(const std::string& type) {
  return type == "model" || type == "position" || type == "door" || type == "lift";
}

Property NumbersProperty(const std::string& name, const std::vector<double>& numbers, const SourceLocation& where) {
  Value::Tuple tuple;
  for (const double number : numbers) tuple.emplace_back(Value::Number{number, PlainNumber(number)});
  return {name, Value{std::move(tuple), where}, where};
}

// The width of a model as declared, in the file's units; x: along the shelf.
double WidthOf(const WorldNode& node, double fallback) {
  const auto* const tuple = node.FindContent<Value::Tuple>("size");
  double width = 0.0;
  for (std::size_t i = 0; tuple != nullptr && i < std::min<std::size_t>(tuple->size(), 2); ++i) {
    if (const auto* number = std::get_if<Value::Number>(&(*tuple)[i])) width = std::max(width, number->value);
  }
  return width > 0.0 ? width : fallback;
}

// An include file is a list of models: each stands beside the one before, at its origin's height.
void AddShelf(WorldTree& tree, const std::string& path, std::set<const WorldNode*>& shelf) {
  std::vector<std::pair<SourceLocation, std::string>> defines;
  for (const auto& [name, define] : tree.defines) {
    if (define.where.file == path) defines.emplace_back(define.where, name);
  }
  std::sort(defines.begin(), defines.end(), [](const auto& a, const auto& b) { return a.first.line < b.first.line; });
  const double metre = 1.0 / UnitsOf(tree.world).metres;
  double x = 0.0;
  for (const auto& [where, name] : defines) {
    Result<WorldNode> made = Instantiate(tree, name, where);
    if (!made.ok() || !HasOwnPlace(made.value().type)) continue;
    WorldNode node = std::move(made).value();
    const double width = WidthOf(node, 0.4 * metre);
    node.Set({"name", Value{name, where}, where});
    node.Set(NumbersProperty("pose", {x + 0.5 * width, 0.0, 0.0, 0.0}, where));
    x += width + kShelfGap * metre;
    tree.world.children.Add(std::move(node));
    shelf.insert(&tree.world.children.back());
  }
}

struct Names {
  std::map<std::string, ModelId> models;
  const WorldDescription& world;
};

// Recursive over the tree, with the poses and full names that the loader gives. Models without an entry in the world,
// as those that a type implies, are no entities.
void AddEntities(const WorldNode& parent, const std::string& parent_name, const WorldNode* parent_node,
                 const Pose& X_WP, const Names& names, const std::set<const WorldNode*>& shelf, EditableWorld& edited) {
  const std::vector<std::string> given = ChildNames(parent);
  for (std::size_t i = 0; i < parent.children.size(); ++i) {
    const WorldNode& node = parent.children[i];
    if (given[i].empty()) continue;
    const std::string name = FullName(parent_name, given[i]);
    const auto found = names.models.find(name);
    if (found == names.models.end()) continue;
    const ModelDescription& model = names.world.model(found->second);
    if (!model.parent) {
      edited.entities.push_back({name, node.type, node.macros.empty() ? node.type : node.macros.front(), found->second,
                                 node.where, shelf.contains(&node), &node, parent_node, X_WP});
    }
    AddEntities(node, name, &node, PoseInWorld(names.world, found->second), names, shelf, edited);
  }
}

constexpr std::size_t kMaxPictureBlocks = 200;
constexpr std::size_t kMaxPictureCorners = 200;

// Tenths of a millimetre: fewer bytes.
double Rounded(double value) {
  return std::round(value * 1e4) / 1e4;
}

// Bounded: a picture is a symbol in the palette, and there may be hundreds.
void AddToPicture(nlohmann::json& blocks, const Polygon& outline, const ZRange& z, const Pose& X_WM,
                  const Color& color) {
  if (blocks.size() >= kMaxPictureBlocks || outline.size() > kMaxPictureCorners) return;
  const Transform2 to_world(X_WM);
  nlohmann::json corners = nlohmann::json::array();
  for (const Vec2& corner : outline) {
    const Vec2 p = to_world * corner;
    corners.push_back({Rounded(p.x()), Rounded(p.y())});
  }
  blocks.push_back({{"outline", std::move(corners)},
                    {"z", {Rounded(X_WM.z + z.min), Rounded(X_WM.z + z.max)}},
                    {"color", {Rounded(color.r), Rounded(color.g), Rounded(color.b)}}});
}

constexpr double kWall = 0.1;        // m, thickness and a part of the height of the room's walls
constexpr double kWallHeight = 0.5;  // m
constexpr double kMinHalf = 3.0;     // m, half the width of the room
constexpr double kProbeWidth = 0.3;  // m

// Entries in the units of the tree to which they are added.
class TreeBuilder {
 public:
  explicit TreeBuilder(const WorldTree& tree) : units_(UnitsOf(tree.world)) {}

  // Lengths in m, the heading in radians.
  WorldNode Make(const std::string& type, const std::string& name, const std::vector<double>& size,
                 const std::vector<double>& pose, const std::string& color) const {
    WorldNode node;
    node.type = type;
    SetText(node, "name", name);
    SetText(node, "color", color);
    SetLengths(node, "size", size);
    SetPose(node, pose);
    return node;
  }
  static void SetText(WorldNode& node, const std::string& name, const std::string& text) {
    node.Set({name, Value{text, {}}, {}});
  }
  void SetPose(WorldNode& node, const std::vector<double>& pose) const {
    Value::Tuple tuple;
    for (std::size_t i = 0; i < pose.size(); ++i)
      tuple.push_back(Number(pose[i] / (i == 3 ? units_.radians : units_.metres)));
    node.Set({"pose", Value{std::move(tuple), {}}, {}});
  }

 private:
  static Value::Number Number(double value) { return {value, PlainNumber(value)}; }
  void SetLengths(WorldNode& node, const std::string& name, const std::vector<double>& lengths) const {
    Value::Tuple tuple;
    for (const double length : lengths) tuple.push_back(Number(length / units_.metres));
    node.Set({name, Value{std::move(tuple), {}}, {}});
  }

  FileUnits units_;
};

// For the default controller of a tested robot: `wander` needs one.
bool HasRanger(const WorldNode& node) {
  return std::any_of(node.children.begin(), node.children.end(),
                     [](const WorldNode& child) { return child.type == "ranger" || HasRanger(child); });
}

}  // namespace

const EditedEntity* EditableWorld::Find(const std::string& name) const {
  const auto found =
      std::find_if(entities.begin(), entities.end(), [&](const auto& each) { return each.name == name; });
  return found != entities.end() ? &*found : nullptr;
}

// Recursive by parents; the depth is bounded by the loader.
Pose PoseInWorld(const WorldDescription& world, ModelId id) {
  const ModelDescription& model = world.model(id);
  return model.parent ? PoseInWorld(world, *model.parent) * model.X_PM : model.X_PM;
}

// The tree keeps places in the text, the loaded world is what a run has. An include file has no world, so that a world
// is made of its models (AddShelf).
Result<std::unique_ptr<EditableWorld>> MakeEditedWorld(EditedKind kind, const std::string& text,
                                                       const std::string& path, const NamedFiles& files) {
  auto edited = std::make_unique<EditableWorld>();
  std::set<const WorldNode*> shelf;
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  overrides.allowed = files.allowed;
  if (kind == EditedKind::kScenario) {
    Result<LoadedWorld> loaded = LoadScenarioText(text, path, overrides);
    if (!loaded.ok()) return loaded.error();
    Result<WorldTree> tree = ReadScenarioTree(text, path, overrides);
    if (!tree.ok()) return tree.error();
    edited->loaded = std::move(loaded).value();
    edited->tree = std::move(tree).value();
  } else {
    ParseOptions options;
    options.allowed = files.allowed;
    Result<WorldTree> tree = ParseStageText(text, path, options);
    if (!tree.ok()) return tree.error();
    edited->tree = std::move(tree).value();
    if (kind == EditedKind::kInclude) AddShelf(edited->tree, path, shelf);
    Result<LoadedWorld> loaded = BuildWorld(edited->tree, overrides, {.images = files.images});
    if (!loaded.ok()) return loaded.error();
    edited->loaded = std::move(loaded).value();
  }
  if (kind != EditedKind::kInclude) AppendPlacementWarnings(path, edited->loaded);
  const WorldDescription& world = edited->loaded.world;
  Names names{{}, world};
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    if (!world.models[i].removed) names.models.emplace(world.models[i].name, ModelId(i));
  }
  AddEntities(edited->tree.world, "", nullptr, Pose{}, names, shelf, *edited);
  return edited;
}

std::vector<PaletteModel> PaletteOf(const WorldTree& tree) {
  std::vector<PaletteModel> found;
  for (const auto& [name, define] : tree.defines) {
    const Result<WorldNode> node = Instantiate(tree, name, {});
    if (node.ok() && HasOwnPlace(node.value().type)) found.push_back({name, node.value().type, define.where});
  }
  for (const char* type : {"model", "position"}) found.push_back({type, type, {}});
  return found;
}

// Defines and world properties decide how a model is built; warnings are those of the whole file, and not repeated.
WorldTree WithoutModels(const WorldTree& tree) {
  const WorldNode& world = tree.world;
  return {.world = {world.type, world.macros, world.properties, {}, world.where},
          .defines = tree.defines,
          .files = tree.files,
          .warnings = {},
          .directory = tree.directory};
}

Result<LoadedWorld> BuildAlone(const WorldTree& tree, const std::string& model, const NamedFiles& files) {
  Result<WorldNode> node = Instantiate(tree, model, {});
  if (!node.ok()) return node.error();
  if (!HasOwnPlace(node.value().type)) return Error{{}, "found " + Quoted(model) + ", expected a model or a robot"};
  WorldTree alone = WithoutModels(tree);
  WorldNode made = std::move(node).value();
  made.Set({"name", Value{model, {}}, {}});
  made.Set(NumbersProperty("pose", {0.0, 0.0, 0.0, 0.0}, {}));
  alone.world.children.Add(std::move(made));
  LoadOverrides overrides;
  overrides.allowed = files.allowed;
  return BuildWorld(alone, overrides, {.images = files.images});
}

nlohmann::json PictureOf(const WorldDescription& world) {
  std::vector<ModelId> all;
  for (std::size_t i = 0; i < world.models.size(); ++i) all.emplace_back(i);
  return PictureOf(world, all);
}

nlohmann::json PictureOf(const WorldDescription& world, const std::vector<ModelId>& models) {
  nlohmann::json blocks = nlohmann::json::array();
  for (const ModelId id : models) {
    const ModelDescription& model = world.model(id);
    if (model.removed) continue;
    const Pose X_WM = PoseInWorld(world, id);
    const Shape& shape = world.shape(model.shape);
    for (const Block& block : shape.blocks) AddToPicture(blocks, block.outline, block.z, X_WM, model.color);
    for (const Rectangle& r : shape.rectangles) {
      const Polygon outline{{r.min_x, r.min_y}, {r.max_x, r.min_y}, {r.max_x, r.max_y}, {r.min_x, r.max_y}};
      AddToPicture(blocks, outline, shape.rectangles_z, X_WM, model.color);
    }
  }
  return blocks;
}

// A robot meets boxes, and another model meets a robot. The room closes the test, so that nothing leaves the view.
Result<LoadedWorld> MakeTestWorld(const WorldTree& tree, const std::string& model, double probe_height,
                                  const NamedFiles& files) {
  const Result<LoadedWorld> alone = BuildAlone(tree, model, files);
  if (!alone.ok()) return alone.error();
  const ModelDescription& root = alone.value().world.models.front();
  const double half = std::max(kMinHalf, 1.5 * std::max(root.size_x, root.size_y));
  Result<WorldNode> made = Instantiate(tree, model, {});
  if (!made.ok()) return made.error();
  const TreeBuilder builder(tree);

  WorldTree test = WithoutModels(tree);
  ChildNodes& children = test.world.children;
  const double side = 2.0 * half + 2.0 * kWall;
  const double middle = half + 0.5 * kWall;
  children.Add(builder.Make("model", "wall:north", {side, kWall, kWallHeight}, {0, middle, 0, 0}, "gray60"));
  children.Add(builder.Make("model", "wall:south", {side, kWall, kWallHeight}, {0, -middle, 0, 0}, "gray60"));
  children.Add(builder.Make("model", "wall:east", {kWall, 2.0 * half, kWallHeight}, {middle, 0, 0, 0}, "gray60"));
  children.Add(builder.Make("model", "wall:west", {kWall, 2.0 * half, kWallHeight}, {-middle, 0, 0, 0}, "gray60"));
  WorldNode tested = std::move(made).value();
  const bool is_robot = tested.type == "position";
  TreeBuilder::SetText(tested, "name", model == kProbe ? "tested" : model);
  builder.SetPose(tested, {0, 0, 0, 0});
  if (is_robot && HasRanger(tested) && tested.Find("ctrl") == nullptr) TreeBuilder::SetText(tested, "ctrl", "wander");
  children.Add(std::move(tested));
  if (is_robot) {
    children.Add(builder.Make("model", "box:1", {0.4, 0.4, 0.4}, {0.6 * half, 0.5 * half, 0, 0}, "tan"));
    children.Add(builder.Make("model", "box:2", {0.4, 0.4, 0.4}, {-0.5 * half, -0.6 * half, 0, 0.5}, "tan"));
  } else {
    children.Add(builder.Make("position", kProbe, {kProbeWidth, kProbeWidth, std::clamp(probe_height, 0.01, 100.0)},
                              {-half + kProbeWidth, 0, 0, 0}, "SteelBlue"));
  }
  LoadOverrides overrides;
  overrides.allowed = files.allowed;
  return BuildWorld(test, overrides, {.images = files.images});
}

}  // namespace troupe
