#include "common/model/check_state.h"

#include <cmath>
#include <string>

#include "troupe/radio_limits.h"

namespace troupe {
namespace {

Error StateError(std::string message) {
  return {.where = {}, .message = std::move(message)};
}

// The rows that a state of the world has; nothing: any number.
template <typename Row>
std::optional<std::size_t> CountRows(const WorldDescription& world, const DeviceCounts& devices) {
  if constexpr (std::is_same_v<Row, RobotState>) return world.robots.size();
  if constexpr (std::is_same_v<Row, JointState>) return world.joints.size();
  if constexpr (std::is_same_v<Row, GripperState>) return world.grippers.size();
  if constexpr (std::is_same_v<Row, ObjectState>) return world.objects.size();
  if constexpr (std::is_same_v<Row, StoreState>) return devices.stores;
  if constexpr (std::is_same_v<Row, ImuState>) return devices.imus;
  if constexpr (std::is_same_v<Row, LightState>) return devices.lights;
  if constexpr (std::is_same_v<Row, CameraState>) return devices.cameras;
  return std::nullopt;
}

bool IsKnown(const WorldDescription& world, ModelId model) {
  return model.index() < world.models.size();
}
bool IsKnown(const WorldDescription& world, RobotId robot) {
  return robot.index() < world.robots.size();
}
bool IsKnown(const WorldDescription& world, GripperId gripper) {
  return gripper.index() < world.grippers.size();
}
bool IsKnown(const WorldDescription& world, ObjectId object) {
  return object.index() < world.objects.size();
}

// Of one state: whether all of its numbers are finite, and all of its ids are those of the world.
class ValueCheck {
 public:
  explicit ValueCheck(const WorldDescription& world) : world_(world) {}

  void operator()(double number) { finite_ = finite_ && std::isfinite(number); }
  template <typename Tag>
  void operator()(Id<Tag> id) {
    known_ = known_ && IsKnown(world_, id);
  }
  template <typename Tag>
  void operator()(const std::optional<Id<Tag>>& id) {
    known_ = known_ && (!id || IsKnown(world_, *id));
  }
  template <typename Number>
  requires(std::is_integral_v<Number> || std::is_enum_v<Number>) void operator()(Number) {}  // any
  void operator()(const std::vector<std::uint8_t>&) {}                                       // any

  Status status() const {
    if (!finite_) return StateError("found a number that is not finite in a state");
    if (!known_) return StateError("found an id in a state that the world does not have");
    return {};
  }

 private:
  const WorldDescription& world_;
  bool finite_ = true;
  bool known_ = true;
};

}  // namespace

DeviceCounts CountDevices(const WorldDescription& world) {
  return {.stores = FindStores(world).size(),
          .imus = FindImus(world).size(),
          .lights = FindLights(world).size(),
          .cameras = FindCameras(world).size()};
}

Status CheckState(const WorldDescription& world, const WorldState& state) {
  return CheckState(world, CountDevices(world), state);
}

Status CheckState(const WorldDescription& world, const DeviceCounts& devices, const WorldState& state) {
  Status problem;
  ValueCheck check(world);
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    const std::vector<Row>& rows = table.Of(state);
    const std::size_t expected = CountRows<Row>(world, devices).value_or(rows.size());
    if (problem.ok() && rows.size() != expected) {
      problem = StateError("found a state of " + std::to_string(rows.size()) + " " + std::string(table.name) +
                           ", expected " + std::to_string(expected));
    }
    for (const Row& row : rows) ForEachLeaf<Row>([&](const auto& leaf) { check(leaf.Of(row)); });
  });
  if (problem.ok()) problem = check.status();
  if (!problem.ok()) return problem;
  for (const ObjectState& object : state.objects) {
    if ((object.mode == ObjectMode::kHeld) != object.holder.has_value()) {
      return StateError("found an object that is held without a holder, or has a holder without being held");
    }
  }
  for (const RadioTransmission& transmission : state.transmissions) {
    if (FindRadio(world.robot(transmission.from), transmission.message.radio) == nullptr) {
      return StateError("found a radio message of a sensor that is no radio");
    }
    if (transmission.due < state.tick || transmission.sent > state.tick) {
      return StateError("found a radio message that is not on its way");
    }
  }
  return {};
}

}  // namespace troupe
