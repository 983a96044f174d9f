#include "world-service/replay/state_difference.h"

#include <fmt/format.h>

#include <cstdint>

namespace troupe {
namespace {

// Compares one model's fields, and keeps the first difference.
class Comparison {
 public:
  Comparison(const WorldDescription& world, ModelId model) : world_(world), model_(model) {}

  void Number(const char* field, double found, double expected) {
    if (found != expected) Keep(field, fmt::format("{}", found), fmt::format("{}", expected));
  }
  void Flag(const char* field, bool found, bool expected) {
    if (found != expected) Keep(field, found ? "true" : "false", expected ? "true" : "false");
  }
  void Number(const char* field, std::uint8_t found, std::uint8_t expected) {
    if (found != expected) Keep(field, std::to_string(found), std::to_string(expected));
  }
  void ThePose(const Pose& found, const Pose& expected) {
    Number("x", found.x, expected.x);
    Number("y", found.y, expected.y);
    Number("z", found.z, expected.z);
    Number("heading", found.heading, expected.heading);
  }
  template <typename Id, typename ModelOf>
  void Reference(const char* field, const std::optional<Id>& found, const std::optional<Id>& expected,
                 const ModelOf& model_of) {
    const auto name = [&](const std::optional<Id>& id) { return id ? NameOf(model_of(*id)) : std::string("none"); };
    if (found != expected) Keep(field, name(found), name(expected));
  }

  const std::optional<StateDifference>& first() const { return first_; }

 private:
  std::string NameOf(std::optional<ModelId> model) const {
    const bool known = model && model->index() < world_.models.size();
    return known ? world_.model(*model).name : std::string("an unknown model");
  }
  void Keep(const char* field, std::string found, std::string expected) {
    if (!first_) first_ = {NameOf(model_), field, std::move(found), std::move(expected)};
  }

  const WorldDescription& world_;
  const ModelId model_;
  std::optional<StateDifference> first_;
};

template <typename Items, typename Compare>
std::optional<StateDifference> CompareAll(const char* kind, const Items& found, const Items& expected,
                                          const Compare& compare) {
  if (found.size() != expected.size()) {
    return StateDifference{"the world", fmt::format("number of {}", kind), std::to_string(found.size()),
                           std::to_string(expected.size())};
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (auto difference = compare(i, found[i], expected[i])) return difference;
  }
  return std::nullopt;
}

}  // namespace

std::optional<StateDifference> FindDifference(const WorldDescription& world, const WorldState& found,
                                              const WorldState& expected) {
  const auto same_model = [](ModelId model) { return std::optional(model); };
  const auto object_model = [&](ObjectId object) {
    return object.index() < world.objects.size() ? std::optional(world.objects[object.index()]) : std::nullopt;
  };
  const auto gripper_model = [&](GripperId gripper) {
    return gripper.index() < world.grippers.size() ? std::optional(world.grippers[gripper.index()].model)
                                                   : std::nullopt;
  };
  const auto robots = [&](std::size_t i, const RobotState& a, const RobotState& b) {
    Comparison comparison(world, world.robots[i].root);
    comparison.ThePose(a.X_WR, b.X_WR);
    comparison.Number("vx", a.twist.vx, b.twist.vx);
    comparison.Number("vy", a.twist.vy, b.twist.vy);
    comparison.Number("wz", a.twist.wz, b.twist.wz);
    comparison.Flag("stalled", a.stalled, b.stalled);
    return comparison.first();
  };
  const auto joints = [&](std::size_t i, const JointState& a, const JointState& b) {
    Comparison comparison(world, world.joints[i].model);
    comparison.Number("joint position", a.position, b.position);
    comparison.Number("joint velocity", a.velocity, b.velocity);
    comparison.Flag("blocked", a.blocked, b.blocked);
    return comparison.first();
  };
  const auto grippers = [&](std::size_t i, const GripperState& a, const GripperState& b) {
    Comparison comparison(world, world.grippers[i].model);
    comparison.Reference("left contact", a.left_contact, b.left_contact, same_model);
    comparison.Reference("right contact", a.right_contact, b.right_contact, same_model);
    comparison.Reference("object between the pads", a.clamped, b.clamped, object_model);
    return comparison.first();
  };
  const auto objects = [&](std::size_t i, const ObjectState& a, const ObjectState& b) {
    Comparison comparison(world, world.objects[i]);
    comparison.ThePose(a.X_WO, b.X_WO);
    comparison.Number("mode", static_cast<std::uint8_t>(a.mode), static_cast<std::uint8_t>(b.mode));
    comparison.Number("fall speed", a.fall_speed, b.fall_speed);
    comparison.Reference("holder", a.holder, b.holder, gripper_model);
    comparison.Reference("support", a.support, b.support, same_model);
    return comparison.first();
  };
  const auto transmissions = [&](std::size_t, const RadioTransmission& a,
                                 const RadioTransmission& b) -> std::optional<StateDifference> {
    if (a == b) return std::nullopt;
    const std::string name = b.from.index() < world.robots.size() ? world.robot(b.from).name : "a robot";
    const auto text = [](const RadioTransmission& transmission) {
      return std::to_string(transmission.message.bytes.size()) + " bytes of tick " + std::to_string(transmission.sent);
    };
    return StateDifference{name, "radio message", text(a), text(b)};
  };
  if (found.tick != expected.tick) {
    return StateDifference{"the world", "tick", std::to_string(found.tick), std::to_string(expected.tick)};
  }
  if (auto difference = CompareAll("robots", found.robots, expected.robots, robots)) return difference;
  if (auto difference = CompareAll("joints", found.joints, expected.joints, joints)) return difference;
  if (auto difference = CompareAll("grippers", found.grippers, expected.grippers, grippers)) return difference;
  if (auto difference = CompareAll("objects", found.objects, expected.objects, objects)) return difference;
  const auto stores = [&, models = FindStores(world)](std::size_t i, const StoreState& a, const StoreState& b) {
    Comparison comparison(world, i < models.size() ? models[i] : ModelId(0));
    comparison.Number("energy", a.joules, b.joules);
    comparison.Number("charge", a.charge_watts, b.charge_watts);
    return comparison.first();
  };
  if (auto difference = CompareAll("stores of energy", found.stores, expected.stores, stores)) return difference;
  const auto robot_of = [&](const std::vector<SensorPlace>& places, std::size_t i) {
    return i < places.size() ? world.robot(places[i].robot).root : ModelId(0);
  };
  const auto imus = [&, places = FindImus(world)](std::size_t i, const ImuState& a, const ImuState& b) {
    Comparison comparison(world, robot_of(places, i));
    comparison.Number("former vx of an IMU", a.vx, b.vx);
    comparison.Number("former vy of an IMU", a.vy, b.vy);
    comparison.Number("former vz of an IMU", a.vz, b.vz);
    return comparison.first();
  };
  if (auto difference = CompareAll("inertial measurement units", found.imus, expected.imus, imus)) return difference;
  const auto lights = [&, places = FindLights(world)](std::size_t i, const LightState& a, const LightState& b) {
    Comparison comparison(world, i < places.size() ? places[i].model : ModelId(0));
    comparison.Flag("switched on", a.is_switched_on, b.is_switched_on);
    return comparison.first();
  };
  if (auto difference = CompareAll("lights", found.lights, expected.lights, lights)) return difference;
  const auto cameras = [&, places = FindCameras(world)](std::size_t i, const CameraState& a, const CameraState& b) {
    Comparison comparison(world, robot_of(places, i));
    comparison.Number("pan of a camera", a.pan, b.pan);
    comparison.Number("tilt of a camera", a.tilt, b.tilt);
    return comparison.first();
  };
  if (auto difference = CompareAll("cameras", found.cameras, expected.cameras, cameras)) return difference;
  return CompareAll("radio messages", found.transmissions, expected.transmissions, transmissions);
}

}  // namespace troupe
