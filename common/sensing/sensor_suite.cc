#include "common/sensing/sensor_suite.h"

#include "common/sensing/sensor_registry.h"

namespace troupe {

SensorSuite::SensorSuite(const Scene& scene, RobotId robot)
    : sensors_(MakeSensors(scene, robot)), subscribed_(sensors_.size(), false), readings_(sensors_.size()) {}

void SensorSuite::CopyReadings(const SensorSuite& other) {
  subscribed_ = other.subscribed_;
  readings_ = other.readings_;
}

void SensorSuite::Update(const SensedWorld& world, Tick tick) {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    if (subscribed_[i] && sensors_[i]->IsDueAt(tick)) sensors_[i]->MeasureInto(world, tick, readings_[i]);
  }
}

const SensorReading& SensorSuite::Measure(std::size_t index, const SensedWorld& world, Tick tick) {
  const SensorReading& reading = readings_[index];
  if (!reading.empty() && reading.tick == tick) return reading;
  sensors_[index]->MeasureInto(world, tick, unsubscribed_);
  return unsubscribed_;
}

}  // namespace troupe
