// Sensors of any kind on the robots of test worlds, and their readings.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/sensing/sensor_suite.h"
#include "common/spatial/body_index.h"
#include "troupe/world_state.h"

namespace troupe::test {

// Adds a sensor mounted at X_RM to a robot; returns its index among the robot's sensors. A model of its own without a
// body carries it.
inline std::size_t AddSensor(WorldDescription& world, RobotId robot, const Pose& X_RM, SensorParameters parameters) {
  RobotDescription& description = world.robots[robot.index()];
  const std::size_t index = description.sensors.size();
  SensorDescription sensor{.name = std::string(TypeOf(parameters)) + ":" + std::to_string(index),
                           .model = ModelId(world.models.size()),
                           .parameters = std::move(parameters)};
  ModelDescription model{.name = description.name + "." + sensor.name,
                         .type = std::string(TypeOf(sensor.parameters)),
                         .parent = description.root,
                         .X_PM = X_RM,
                         .shape = ShapeId(world.shapes.size())};
  world.shapes.emplace_back();
  world.models.push_back(std::move(model));
  description.sensors.push_back(std::move(sensor));
  return index;
}

// A world at one state, ready for measurements.
class SensedScene {
 public:
  explicit SensedScene(WorldDescription world) : SensedScene(std::move(world), std::nullopt) {}
  SensedScene(WorldDescription world, std::optional<WorldState> state)
      : scene_(std::make_unique<const Scene>(std::move(world))),
        state_(state ? *std::move(state) : PlacedState(scene_->world())),
        bodies_(*scene_) {
    bodies_.Assign(state_);
  }

  const Scene& scene() const { return *scene_; }
  const WorldState& state() const { return state_; }
  SensedWorld world() const { return {*scene_, bodies_, &state_}; }

  SensorReading Measure(RobotId robot, std::size_t sensor) const {
    return MakeSensors(*scene_, robot).at(sensor)->Measure(world(), state_.tick);
  }
  template <typename Reading>
  Reading MeasureAs(RobotId robot, std::size_t sensor) const {
    return std::get<Reading>(Measure(robot, sensor).content);
  }
  std::string JsonLines(RobotId robot, std::size_t sensor) const {
    return MakeSensors(*scene_, robot).at(sensor)->JsonLines(scene_->world(), Measure(robot, sensor));
  }

 private:
  std::unique_ptr<const Scene> scene_;  // its address stays when this is moved
  WorldState state_;
  BodyIndex bodies_;
};

}  // namespace troupe::test
