#include "common/sensing/sensor.h"

#include <charconv>
#include <nlohmann/json.hpp>

#include "common/base/json.h"

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
  return world.bodies.X_BL(body)[world.scene.link_of(model)] * world.scene.X_LM(model);
}

std::string LineStart(Tick tick, const std::string& robot, const std::string& sensor) {
  return "{\"tick\":" + std::to_string(tick) + ",\"robot\":" + JsonString(robot) + ",\"sensor\":" + JsonString(sensor);
}

std::string JsonString(const std::string& text) {
  return JsonText(nlohmann::json(text));
}

std::string JsonNumbers(std::span<const double> values) {
  std::string text = "[";
  text.reserve(2 + 20 * values.size());
  for (const double value : values) {
    char digits[32];
    if (text.size() > 1) text += ',';
    text.append(digits, std::to_chars(digits, digits + sizeof(digits), value).ptr);
  }
  return text + "]";
}

std::string JsonNumber(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof(digits), value).ptr};
}

}  // namespace troupe
