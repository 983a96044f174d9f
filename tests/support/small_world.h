// SmallWorld: builds a world description from boxes and robots, for tests.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "troupe/world_description.h"

namespace troupe {

// The ray sensors of a sensor that is a ranger.

inline std::vector<RaySensorDescription>& RaySensors(SensorDescription& ranger) {
  return std::get<RangerParameters>(ranger.parameters).ray_sensors.Change();
}
inline const std::vector<RaySensorDescription>& RaySensors(const SensorDescription& ranger) {
  return std::get<RangerParameters>(ranger.parameters).ray_sensors;
}

class SmallWorld {
 public:
  SmallWorld() {
    world_.name = "small";
    world_.seed = 1;
  }

  // A static box of the given size (m) with its centre at (x, y), and its material over `z`.
  ModelDescription& AddBox(const std::string& name, double x, double y, double size_x, double size_y, ZRange z) {
    return AddModel(name, std::nullopt, {x, y, 0.0, 0.0}, size_x, size_y, z);
  }

  // A box on a robot, posed in its root model's frame.
  ModelDescription& AddPart(RobotId robot, const std::string& name, const Pose& X_RM, double size_x, double size_y,
                            ZRange z) {
    return AddModel(world_.robot(robot).name + "." + name, world_.robot(robot).root, X_RM, size_x, size_y, z);
  }

  // A robot with a cube of 0.4 m as its body, a differential drive of at most 1 m/s and 2 rad/s, and strong motors.
  RobotId AddRobot(const std::string& name, const Pose& X_WR) {
    const ModelId root(world_.models.size());
    AddModel(name, std::nullopt, X_WR, 0.4, 0.4, {0.0, 0.4}).type = "position";
    RobotDescription robot{.name = name, .root = root};
    robot.drive.velocity = {{-1.0, 1.0}, {-1.0, 1.0}, {-2.0, 2.0}};
    robot.drive.acceleration = {{-100.0, 100.0}, {-100.0, 100.0}, {-100.0, 100.0}};
    world_.robots.push_back(robot);
    return RobotId(world_.robots.size() - 1);
  }

  // A ranger mounted at X_RM. Returns its index among the robot's sensors.
  std::size_t AddRanger(RobotId robot, const Pose& X_RM, std::vector<RaySensorDescription> sensors) {
    RobotDescription& description = world_.robots[robot.index()];
    const std::size_t index = description.sensors.size();
    ModelDescription model{.name = description.name + ".ranger:" + std::to_string(index),
                           .type = "ranger",
                           .parent = description.root,
                           .X_PM = X_RM,
                           .shape = ShapeId(world_.shapes.size())};
    world_.shapes.emplace_back();  // a ranger has no body
    SensorDescription ranger{.name = "ranger:" + std::to_string(index),
                             .model = ModelId(world_.models.size()),
                             .parameters = RangerParameters{std::move(sensors)}};
    world_.models.push_back(model);
    description.sensors.push_back(ranger);
    return index;
  }

  void SetController(RobotId robot, const std::string& name, const std::string& parameters = "{}") {
    world_.robots[robot.index()].controller = {name, parameters};
  }

  RobotDescription& robot(RobotId id) { return world_.robots[id.index()]; }
  WorldDescription& world() { return world_; }

 private:
  ModelDescription& AddModel(const std::string& name, std::optional<ModelId> parent, const Pose& X_PM, double size_x,
                             double size_y, ZRange z) {
    const double x = 0.5 * size_x;
    const double y = 0.5 * size_y;
    Shape shape;
    shape.blocks.push_back({.outline = {{-x, -y}, {x, -y}, {x, y}, {-x, y}}, .z = z});
    ModelDescription model{.name = name,
                           .type = "model",
                           .parent = parent,
                           .X_PM = X_PM,
                           .shape = ShapeId(world_.shapes.size()),
                           .size_x = size_x,
                           .size_y = size_y,
                           .size_z = z.max};
    world_.shapes.push_back(shape);
    world_.models.push_back(model);
    return world_.models.back();
  }

  WorldDescription world_;
};

// One ray straight ahead, of at most `range` m.
inline RaySensorDescription OneRay(double range = 5.0) {
  return {.range = {0.0, range}, .samples = 1};
}

// A fan of rays over `fov` rad.
inline RaySensorDescription Fan(double fov, std::uint32_t samples, double range = 5.0) {
  return {.range = {0.0, range}, .fov = fov, .samples = samples};
}

// A world for runs of several robots.
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
