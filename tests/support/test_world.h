// Small worlds for tests, built in a line or two each.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe::test {

inline Polygon Box(double min_x, double min_y, double max_x, double max_y) {
  return {{min_x, min_y}, {max_x, min_y}, {max_x, max_y}, {min_x, max_y}};
}

// A square of edge length `size` about the origin.
inline Polygon Square(double size) {
  return Box(-0.5 * size, -0.5 * size, 0.5 * size, 0.5 * size);
}

// A drive that reaches any twist at once.
inline DriveDescription UnboundedDrive() {
  const Interval any{-1e6, 1e6};
  return {.type = DriveType::kOmni, .wheelbase = 1.0, .velocity = {any, any, any}, .acceleration = {any, any, any}};
}

class TestWorld {
 public:
  // Adds a model to the world or, with a parent, to another model; returns its id.
  ModelId AddModel(std::vector<Block> blocks, const Pose& X_PM = {}, std::optional<ModelId> parent = {}) {
    ModelDescription model;
    model.name = "m" + std::to_string(world.models.size());
    model.type = "model";
    model.parent = parent;
    model.X_PM = X_PM;
    model.shape = ShapeId(world.shapes.size());
    world.shapes.push_back({.blocks = std::move(blocks), .rectangles = {}, .rectangles_z = {}});
    world.models.push_back(std::move(model));
    return ModelId(world.models.size() - 1);
  }
  ModelId AddModel(const Polygon& outline, const ZRange& z = {0.0, 1.0}, const Pose& X_PM = {},
                   std::optional<ModelId> parent = {}) {
    return AddModel({Block{outline, z}}, X_PM, parent);
  }
  RobotId AddRobot(const Polygon& outline, const ZRange& z, const Pose& X_WR) {
    const ModelId root = AddModel(outline, z, X_WR);
    world.models.back().type = "position";
    RobotDescription robot;
    robot.name = world.models.back().name;
    robot.root = root;
    robot.drive = UnboundedDrive();
    world.robots.push_back(std::move(robot));
    return RobotId(world.robots.size() - 1);
  }
  ModelDescription& model(ModelId id) { return world.models[id.index()]; }

  WorldDescription world;
};

}  // namespace troupe::test
