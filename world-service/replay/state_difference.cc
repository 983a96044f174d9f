#include "world-service/replay/state_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace troupe {
namespace {

// The model of each row of a kind, as far as the rows belong to models.
template <typename Row>
std::vector<ModelId> ModelsOf(const WorldDescription& world) {
  std::vector<ModelId> models;
  const auto add = [&](const auto& places, const auto& model_of) {
    for (const auto& place : places) models.push_back(model_of(place));
  };
  const auto robot_of = [&](const SensorPlace& place) { return world.robot(place.robot).root; };
  if constexpr (std::is_same_v<Row, RobotState>) add(world.robots, [](const auto& robot) { return robot.root; });
  if constexpr (std::is_same_v<Row, JointState>) add(world.joints, [](const auto& joint) { return joint.model; });
  if constexpr (std::is_same_v<Row, GripperState>) add(world.grippers, [](const auto& g) { return g.model; });
  if constexpr (std::is_same_v<Row, ObjectState>) models = world.objects;
  if constexpr (std::is_same_v<Row, StoreState>) models = FindStores(world);
  if constexpr (std::is_same_v<Row, ImuState>) add(FindImus(world), robot_of);
  if constexpr (std::is_same_v<Row, LightState>) add(FindLights(world), [](const auto& light) { return light.model; });
  if constexpr (std::is_same_v<Row, CameraState>) add(FindCameras(world), robot_of);
  return models;
}

class ValueText {
 public:
  explicit ValueText(const WorldDescription& world) : world_(world) {}

  std::string operator()(double number) const { return fmt::format("{}", number); }
  std::string operator()(bool flag) const { return flag ? "true" : "false"; }
  template <typename Number>
  requires(std::is_integral_v<Number> || std::is_enum_v<Number>) std::string operator()(Number number) const {
    return std::to_string(static_cast<std::uint64_t>(number));
  }
  std::string operator()(const std::vector<std::uint8_t>& bytes) const {
    return std::to_string(bytes.size()) + " bytes";
  }
  template <typename Tag>
  std::string operator()(const std::optional<Id<Tag>>& id) const {
    return id ? (*this)(*id) : "none";
  }
  std::string operator()(ModelId model) const { return NameOf(world_.models, model.index()); }
  std::string operator()(RobotId robot) const { return NameOf(world_.robots, robot.index()); }
  std::string operator()(ObjectId object) const {
    return object.index() < world_.objects.size() ? (*this)(world_.objects[object.index()]) : kUnknown;
  }
  std::string operator()(GripperId gripper) const {
    return gripper.index() < world_.grippers.size() ? (*this)(world_.grippers[gripper.index()].model) : kUnknown;
  }

 private:
  static constexpr const char* kUnknown = "an unknown model";

  template <typename Named>
  static std::string NameOf(const std::vector<Named>& list, std::size_t index) {
    return index < list.size() ? list[index].name : kUnknown;
  }

  const WorldDescription& world_;
};

std::string Spaced(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

// "joint velocity"; of robots and objects, whose models the difference names, just "x".
template <typename Row>
std::string FieldName(std::string_view table, std::string_view leaf) {
  if constexpr (std::is_same_v<Row, RobotState> || std::is_same_v<Row, ObjectState>) return Spaced(leaf);
  return std::string(table.substr(0, table.size() - 1)) + " " + Spaced(leaf);
}

}  // namespace

std::optional<StateDifference> FindDifference(const WorldDescription& world, const WorldState& found,
                                              const WorldState& expected) {
  const ValueText text(world);
  std::optional<StateDifference> first;
  if (found.tick != expected.tick) {
    return StateDifference{"the world", "tick", text(found.tick), text(expected.tick)};
  }
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    const std::vector<Row>& found_rows = table.Of(found);
    const std::vector<Row>& expected_rows = table.Of(expected);
    if (first) return;
    if (found_rows.size() != expected_rows.size()) {
      first = {"the world", "number of " + std::string(table.name), text(found_rows.size()),
               text(expected_rows.size())};
      return;
    }
    const auto [a, b] = std::mismatch(found_rows.begin(), found_rows.end(), expected_rows.begin());
    if (a == found_rows.end()) return;
    const std::vector<ModelId> models = ModelsOf<Row>(world);
    const auto row = static_cast<std::size_t>(a - found_rows.begin());
    const std::string model = row < models.size() ? text(models[row]) : "the world";
    ForEachLeaf<Row>([&, &from = *a, &to = *b](const auto& leaf) {
      if (first || leaf.Of(from) == leaf.Of(to)) return;
      first = {model, FieldName<Row>(table.name, leaf.name), text(leaf.Of(from)), text(leaf.Of(to))};
    });
  });
  return first;
}

}  // namespace troupe
