#include "common/sensing/sensor.h"

namespace troupe {

Sensor::Sensor(const SensorMount& mount) : robot_(mount.robot), index_(mount.index), description_(mount.description) {}

SensorReading Sensor::Measure(const SensedWorld& world, Tick tick) const {
  SensorReading reading;
  MeasureInto(world, tick, reading);
  return reading;
}

void Sensor::AddMarks(const SensedWorld& /*world*/, const SensorReading& /*reading*/,
                      std::vector<Mark>& /*marks*/) const {}

Pose Sensor::MountAt(const SensedWorld& world) const {
  const BodyId body = world.scene.body_of(robot());
  const ModelId model = description().model;
  // Through the link: joints may move the model within the robot.
  return world.bodies.X_BL(body)[world.scene.link_of(model)] * world.scene.X_LM(model);
}

void BeginReading(JsonWriter& json, Tick tick, const std::string& robot, const std::string& sensor) {
  json.BeginObject().Member("tick", tick).Member("robot", robot).Member("sensor", sensor);
}

}  // namespace troupe
