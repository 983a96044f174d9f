// A world for runs of several robots.
#pragma once

#include <string>
#include <vector>

#include "tests/support/small_world.h"

namespace troupe {

// Robots with noisy sonars and the controllers wander and expand: six in a walled yard, the others in rows beside it.
inline WorldDescription Yard(int robots = 6) {
  SmallWorld world;
  for (int side = 0; side < 4; ++side) {
    const bool along_x = side % 2 == 0;
    const double at = side < 2 ? -4.0 : 4.0;
    world.AddBox("wall" + std::to_string(side), along_x ? 0.0 : at, along_x ? at : 0.0, along_x ? 9.0 : 0.2,
                 along_x ? 0.2 : 9.0, {0.0, 1.0});
  }
  for (int i = 0; i < robots; ++i) {
    const Pose X_WR{0.9 * (i % 6) - 2.2, 0.3 * (i % 6) + 9.0 * (i / 6), 0.0, WrapAngle(0.5 * i)};
    const RobotId robot = world.AddRobot("r" + std::to_string(i), X_WR);
    std::vector<RaySensorDescription> ring;
    for (int k = 0; k < 8; ++k) {
      RaySensorDescription sonar = OneRay();
      sonar.X_MS.heading = WrapAngle(k * kPi / 4);
      sonar.noise_variance = 1e-4;
      ring.push_back(sonar);
    }
    world.AddRanger(robot, {0.0, 0.0, 0.2, 0.0}, ring);
    world.SetController(robot, i % 2 == 0 ? "wander" : "expand");
    world.robot(robot).localization.type = LocalizationType::kOdometry;
  }
  return world.world();
}

}  // namespace troupe
