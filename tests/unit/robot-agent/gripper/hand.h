// A robot with a lift, two fingers and an arm that turns, as a description; and a substitute for the step that
// moves its joints: they stop at their limits and at obstacles that a test sets.
#pragma once

#include <array>
#include <limits>
#include <string>

#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe::test {

class Hand {
 public:
  static constexpr std::size_t kLift = 0;
  static constexpr std::size_t kLeft = 1;
  static constexpr std::size_t kRight = 2;
  static constexpr std::size_t kArm = 3;

  Hand() {
    world.shapes.resize(1);
    for (const char* name : {"r0", "r0.lift", "r0.left", "r0.right", "r0.arm", "box", "wall"}) {
      world.models.emplace_back().name = name;
      world.models.back().parent = ModelId(0);
      world.models.back().shape = ShapeId(0);
    }
    for (std::size_t root : {0u, 5u, 6u}) world.models[root].parent.reset();
    world.models[2].parent = world.models[3].parent = ModelId(1);
    world.models[5].gripper_return = true;
    world.objects = {ModelId(5)};
    world.robots.emplace_back().name = "r0";
    world.robots.back().root = ModelId(0);
    for (std::size_t i = 0; i < 4; ++i) {
      JointDescription& joint = world.joints.emplace_back();
      joint.name = world.models[i + 1].name.substr(3);
      joint.robot = RobotId(0);
      joint.model = ModelId(i + 1);
      joint.position = i == kLift ? Interval{0.25, 1.25} : i == kArm ? Interval{-2.0, 2.0} : Interval{0.0, 0.5};
      joint.start = i == kArm ? 0.0 : joint.position.min;
      joint.max_speed = i == kArm ? 2.0 : 0.5;
      if (i == kArm) joint.type = JointType::kRevolute;
    }
    GripperDescription& gripper = world.grippers.emplace_back();
    gripper.name = "lift";
    gripper.robot = RobotId(0);
    gripper.model = ModelId(1);
    gripper.left = JointId(kLeft);
    gripper.right = JointId(kRight);
    gripper.left_pad = ModelId(2);
    gripper.right_pad = ModelId(3);
    gripper.lift = JointId(kLift);
    gripper.beams.resize(2);
    state = PlacedState(world);
    stops.fill(std::numeric_limits<double>::infinity());
  }

  double& position(std::size_t joint) { return state.joints[joint].position; }

  // One tick. A joint that would pass its stop is blocked there; an empty list moves none.
  void Move(const std::vector<double>& velocities) {
    const double seconds = world.interval_seconds();
    ++state.tick;
    for (std::size_t i = 0; i < state.joints.size(); ++i) {
      JointState& joint = state.joints[i];
      const double velocity = velocities.empty() ? 0.0 : velocities[i];
      double next = world.joints[i].position.Clamp(joint.position + velocity * seconds);
      joint.blocked = next > stops[i];
      if (joint.blocked) next = stops[i];
      joint.velocity = joint.blocked ? 0.0 : (next - joint.position) / seconds;
      joint.position = next;
    }
  }

  WorldDescription world;
  WorldState state;
  std::array<double, 4> stops;  // by joint, m or rad
};

}  // namespace troupe::test
