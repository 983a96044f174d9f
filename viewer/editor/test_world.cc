#include "viewer/editor/test_world.h"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "worldfile/edit/text_change.h"
#include "worldfile/models/build_world.h"
#include "worldfile/stage/stage_world.h"

namespace troupe {
namespace {

constexpr double kWall = 0.1;        // m, thickness and a part of the height of the room's walls
constexpr double kWallHeight = 0.5;  // m
constexpr double kLeastHalf = 3.0;   // m, half the width of the room
constexpr double kProbeWidth = 0.3;  // m

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

bool HasRanger(const WorldNode& node) {
  return std::any_of(node.children.begin(), node.children.end(),
                     [](const WorldNode& child) { return child.type == "ranger" || HasRanger(child); });
}

}  // namespace

Result<LoadedWorld> MakeTestWorld(const WorldTree& tree, const std::string& model, double probe_height,
                                  const NamedFiles& files) {
  const Result<LoadedWorld> alone = BuildAlone(tree, model, files);
  if (!alone.ok()) return alone.error();
  const ModelDescription& root = alone.value().world.models.front();
  const double half = std::max(kLeastHalf, 1.5 * std::max(root.size_x, root.size_y));
  Result<WorldNode> made = Instantiate(tree, model, {});
  if (!made.ok()) return made.error();
  const TreeBuilder builder(tree);

  WorldTree test = WithoutModels(tree);
  std::vector<WorldNode>& children = test.world.children;
  const double side = 2.0 * half + 2.0 * kWall;
  const double middle = half + 0.5 * kWall;
  children.push_back(builder.Make("model", "wall:north", {side, kWall, kWallHeight}, {0, middle, 0, 0}, "gray60"));
  children.push_back(builder.Make("model", "wall:south", {side, kWall, kWallHeight}, {0, -middle, 0, 0}, "gray60"));
  children.push_back(builder.Make("model", "wall:east", {kWall, 2.0 * half, kWallHeight}, {middle, 0, 0, 0}, "gray60"));
  children.push_back(
      builder.Make("model", "wall:west", {kWall, 2.0 * half, kWallHeight}, {-middle, 0, 0, 0}, "gray60"));
  WorldNode tested = std::move(made).value();
  const bool is_robot = tested.type == "position";
  TreeBuilder::SetText(tested, "name", model == kProbe ? "tested" : model);
  builder.SetPose(tested, {0, 0, 0, 0});
  if (is_robot && HasRanger(tested) && tested.Find("ctrl") == nullptr) TreeBuilder::SetText(tested, "ctrl", "wander");
  children.push_back(std::move(tested));
  if (is_robot) {
    children.push_back(builder.Make("model", "box:1", {0.4, 0.4, 0.4}, {0.6 * half, 0.5 * half, 0, 0}, "tan"));
    children.push_back(builder.Make("model", "box:2", {0.4, 0.4, 0.4}, {-0.5 * half, -0.6 * half, 0, 0.5}, "tan"));
  } else {
    children.push_back(builder.Make("position", kProbe,
                                    {kProbeWidth, kProbeWidth, std::clamp(probe_height, 0.01, 100.0)},
                                    {-half + kProbeWidth, 0, 0, 0}, "SteelBlue"));
  }
  LoadOverrides overrides;
  overrides.allowed = files.allowed;
  return BuildWorld(test, overrides, {.images = files.images});
}

}  // namespace troupe
