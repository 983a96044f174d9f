// Robots three metres from each other on an empty plane.
#pragma once

#include "benchmarks/cave_world.h"

namespace troupe::bench {

inline WorldDescription SparseWorld(std::size_t robots, int blocks_per_robot) {
  WorldDescription world = CaveWorld(1, blocks_per_robot);
  world.shapes[0].rectangles.clear();
  const ModelDescription model = world.models[1];
  const RobotDescription robot = world.robots[0];
  world.models.resize(1);
  world.robots.clear();
  const auto width = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(robots))));
  for (std::size_t i = 0; i < robots; ++i) {
    world.models.push_back(model);
    world.models.back().name = "r" + std::to_string(i);
    world.models.back().X_PM = {3.0 * static_cast<double>(i % width), 3.0 * static_cast<double>(i / width), 0.0, 0.0};
    world.robots.push_back(robot);
    world.robots.back().name = world.models.back().name;
    world.robots.back().root = ModelId(world.models.size() - 1);
  }
  return world;
}

}  // namespace troupe::bench
