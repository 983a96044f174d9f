#include "world-service/replay/check_start_state.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "common/geometry/limits.h"
#include "common/model/check_state.h"

namespace troupe {
namespace {

Error BadState(const std::string& problem) {
  return {{}, "found a state with " + problem};
}

bool IsWithin(const Pose& pose) {
  return std::abs(pose.x) <= kMaxMagnitude && std::abs(pose.y) <= kMaxMagnitude && std::abs(pose.z) <= kMaxMagnitude &&
         std::abs(pose.heading) <= std::numbers::pi;
}

bool IsWithin(const Twist& twist) {
  return std::abs(twist.vx) <= kMaxMagnitude && std::abs(twist.vy) <= kMaxMagnitude &&
         std::abs(twist.wz) <= kMaxMagnitude;
}

// The object that a model is a part of, by model.
std::vector<std::optional<std::size_t>> ObjectsOfModels(const WorldDescription& world) {
  std::vector<std::optional<std::size_t>> objects(world.models.size());
  for (std::size_t i = 0; i < world.objects.size(); ++i) objects[world.objects[i].index()] = i;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const std::optional<ModelId>& parent = world.models[i].parent;
    if (parent && !objects[i]) objects[i] = objects[parent->index()];  // a parent's id is smaller
  }
  return objects;
}

// An object that is on itself, whatever is between.
bool HasCycle(const WorldDescription& world, const WorldState& state) {
  const std::vector<std::optional<std::size_t>> object_of = ObjectsOfModels(world);
  std::vector<bool> checked(state.objects.size(), false);
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    std::size_t steps = 0;
    for (std::optional<std::size_t> at = i; at && !checked[*at];) {
      if (++steps > state.objects.size()) return true;
      const std::optional<ModelId>& support = state.objects[*at].support;
      at = support ? object_of[support->index()] : std::nullopt;
    }
    for (std::optional<std::size_t> at = i; at && !checked[*at];) {
      checked[*at] = true;
      const std::optional<ModelId>& support = state.objects[*at].support;
      at = support ? object_of[support->index()] : std::nullopt;
    }
  }
  return false;
}

}  // namespace

Status CheckStartState(const WorldDescription& world, const WorldState& state) {
  if (Status problem = CheckState(world, state); !problem.ok()) return problem;
  for (const RobotState& robot : state.robots) {
    if (!IsWithin(robot.X_WR) || !IsWithin(robot.twist)) return BadState("a robot beyond the bounds of a world");
  }
  for (std::size_t i = 0; i < state.joints.size(); ++i) {
    const Interval& bounds = world.joints[i].position;
    const double position = state.joints[i].position;
    const double slack = 1e-6 * (1.0 + std::abs(bounds.min) + std::abs(bounds.max));
    if (position < bounds.min - slack || position > bounds.max + slack) return BadState("a joint beyond its bounds");
  }
  for (const ObjectState& object : state.objects) {
    if (!IsWithin(object.X_WO) || std::abs(object.fall_speed) > kMaxMagnitude) {
      return BadState("an object beyond the bounds of a world");
    }
    if (object.support && object.mode != ObjectMode::kResting)
      return BadState("a support of an object that does not rest");
  }
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    const std::optional<GripperId>& holder = state.objects[i].holder;
    if (holder && state.grippers[holder->index()].clamped != ObjectId(i)) {
      return BadState("an object whose gripper does not hold it");
    }
  }
  if (HasCycle(world, state)) return BadState("objects that support each other");
  return {};
}

}  // namespace troupe
