// Worlds with grippers for tests: robots with a lift and two fingers, boxes, and a driver for their joints.
// Made without a file, so that a test of the step does not depend on the readers of worlds.
#pragma once

#include <string>
#include <vector>

#include "common/model/states.h"
#include "tests/support/test_world.h"
#include "world-service/core/step.h"

namespace troupe::test {

// A robot of 0.4 x 0.4 x 0.3 m. In front, from x = 0.25 to 0.41, two fingers of 0.02 m, 0.1 m high, with 0.3 m between
// them when open; they touch in the middle. The lift raises them from the ground to 1 m.
struct GripperRobot {
  RobotId robot;
  ModelId root;
  ModelId carriage;  // frame G, 0.25 m in front of the robot's origin
  ModelId left_pad;
  ModelId right_pad;
  JointId lift;
  JointId left;
  JointId right;
  GripperId gripper;
};

class GripperWorld : public TestWorld {
 public:
  JointId AddJoint(RobotId robot, ModelId model, const Vec2& axis_xy, double axis_z, const Interval& limits) {
    JointDescription joint;
    joint.name = world.model(model).name;
    joint.robot = robot;
    joint.model = model;
    joint.axis_xy = axis_xy;
    joint.axis_z = axis_z;
    joint.position = limits;
    joint.start = limits.min;
    joint.max_speed = 10.0;
    world.joints.push_back(joint);
    return JointId(world.joints.size() - 1);
  }

  GripperRobot AddGripperRobot(const Pose& X_WR) {
    GripperRobot r;
    r.robot = AddRobot(Square(0.4), {0.0, 0.3}, X_WR);
    r.root = world.robot(r.robot).root;
    r.carriage = AddModel({}, {0.25, 0.0, 0.0, 0.0}, r.root);
    r.lift = AddJoint(r.robot, r.carriage, {0.0, 0.0}, 1.0, {0.0, 1.0});
    r.left_pad = AddModel(Box(0.0, 0.15, 0.16, 0.17), {0.0, 0.1}, {}, r.carriage);
    r.left = AddJoint(r.robot, r.left_pad, {0.0, -1.0}, 0.0, {0.0, 0.15});
    r.right_pad = AddModel(Box(0.0, -0.17, 0.16, -0.15), {0.0, 0.1}, {}, r.carriage);
    r.right = AddJoint(r.robot, r.right_pad, {0.0, 1.0}, 0.0, {0.0, 0.15});
    GripperDescription gripper;
    gripper.name = "gripper";
    gripper.robot = r.robot;
    gripper.model = r.carriage;
    gripper.left = r.left;
    gripper.right = r.right;
    gripper.left_pad = r.left_pad;
    gripper.right_pad = r.right_pad;
    gripper.lift = r.lift;
    world.grippers.push_back(gripper);
    r.gripper = GripperId(world.grippers.size() - 1);
    return r;
  }

  // A box of `size` x `size` x `height` m that grippers can hold.
  ObjectId AddObject(const Pose& X_WO, double size = 0.1, double height = 0.1) {
    const ModelId id = AddModel(Square(size), {0.0, height}, X_WO);
    model(id).gripper_return = true;
    world.objects.push_back(id);
    return ObjectId(world.objects.size() - 1);
  }
};

// The velocities that a test commands one robot for some ticks.
struct GripperDemand {
  Twist twist = {};
  double lift = 0.0;     // m/s, up
  double fingers = 0.0;  // m/s, positive closes
};

// Steps a world and collects the events.
class GripperRun {
 public:
  explicit GripperRun(const WorldDescription& world) : scene(world), state(InitialState(scene)) {}

  void Step(const std::vector<GripperDemand>& demands, int ticks = 1) {
    std::vector<Proposal> proposals;
    for (std::size_t i = 0; i < demands.size(); ++i) {
      proposals.push_back({RobotId(i), demands[i].twist, {}});
      if (scene.joints_of(RobotId(i)).empty()) continue;
      proposals.back().joint_velocities = {demands[i].lift, demands[i].fingers, demands[i].fingers};
    }
    for (int i = 0; i < ticks; ++i) {
      StepResult result = troupe::Step(scene, state, proposals);
      state = std::move(result.state);
      events.insert(events.end(), result.events.begin(), result.events.end());
    }
  }

  const ObjectState& object(ObjectId id) const { return state.objects[id.index()]; }
  double position(JointId id) const { return state.joints[id.index()].position; }
  Pose X_WM(ModelId model) const { return ModelPoses(scene.world(), state)[model.index()]; }
  std::vector<Event> EventsOf(EventType type) const {
    std::vector<Event> found;
    for (const Event& event : events) {
      if (event.type == type) found.push_back(event);
    }
    return found;
  }

  Scene scene;
  WorldState state;
  std::vector<Event> events;
};

}  // namespace troupe::test
