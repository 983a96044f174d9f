// Random scenes with robots that grip, lift, carry and drop any object.
// Boxes are placed before the fingers: uniformly random ones would hardly ever lie between them.
#pragma once

#include "tests/support/gripper_world.h"
#include "tests/support/random_world.h"

namespace troupe::test {

// Robots in a row, `distance` m apart, with boxes before their fingers, shelves, posts, boxes on boxes and on robots,
// some in the air.
inline GripperWorld RandomGrippers(RandomStream& random, std::size_t most_robots = 4, double distance = 1.2) {
  GripperWorld world;
  const std::size_t robots = 1 + random.Index(most_robots);
  for (std::size_t i = 0; i < robots; ++i) {
    const double y = distance * static_cast<double>(i);
    const Pose X_WR{random.Uniform(-0.2, 0.2), y, 0.0, random.Uniform(-0.3, 0.3)};
    const GripperRobot robot = world.AddGripperRobot(X_WR);
    if (random.Chance(0.3)) {  // a roof over the gripper, part of the robot
      world.AddModel(Box(0.1, -0.3, 0.5, 0.3), {0.6, 0.65}, {}, robot.root);
    }
    const Pose X_WO = X_WR * Pose{0.34, random.Uniform(-0.05, 0.05), 0.0, random.Uniform(-0.5, 0.5)};
    const double height = random.Uniform(0.05, 0.2);
    world.AddObject(X_WO, random.Uniform(0.05, 0.12), height);
    if (random.Chance(0.5)) world.AddObject(X_WO * Pose{0.01, 0.0, height, 0.2}, 0.08, 0.1);
    if (random.Chance(0.3)) world.AddObject(X_WR * Pose{0.05, 0.0, 0.3, 0.0}, 0.1, 0.1);
    if (random.Chance(0.3)) world.world.joints[robot.right.index()].max_speed = 1.0;
    const Pose ahead = X_WR * Pose{random.Uniform(0.8, 1.5), random.Uniform(-0.3, 0.3), 0.0, 0.0};
    const double top = random.Uniform(0.05, 0.6);
    switch (random.Index(4)) {
      case 0:
        world.AddModel(Square(0.3), {0.0, top}, ahead);
        break;
      case 1:
        world.AddModel(Square(0.4), {top, top + 0.05}, ahead);
        break;
      case 2:
        world.AddObject(ahead, 0.15, top);
        break;
      default:
        world.AddObject(ahead * Pose{0.0, 0.0, 0.3, 0.0}, 0.1, 0.1);  // in the air
    }
  }
  if (random.Chance(0.2)) world.world.gravity = 0.0;
  return world;
}

inline GripperDemand RandomDemand(RandomStream& random) {
  GripperDemand demand;
  switch (random.Index(6)) {
    case 0:
      demand.fingers = 0.1;
      break;
    case 1:
      demand.fingers = 0.1;
      demand.lift = 0.2;
      break;
    case 2:
      demand.fingers = random.Chance(0.3) ? -0.2 : 0.0;
      demand.lift = -0.3;
      break;
    case 3:
      demand.lift = random.Uniform(-0.5, 0.5);
      [[fallthrough]];
    default:
      demand.twist = {random.Uniform(-0.5, 1.0), random.Chance(0.3) ? random.Uniform(-0.3, 0.3) : 0.0,
                      random.Uniform(-0.5, 0.5)};
  }
  return demand;
}

}  // namespace troupe::test
