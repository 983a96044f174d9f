// SensorSuite: all sensors of one robot with the last readings of those that have a reader.
//
// Threads: one at a time.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/sensing/sensor.h"

namespace troupe {

class SensorSuite {
 public:
  SensorSuite(const Scene& scene, RobotId robot);

  std::size_t size() const { return sensors_.size(); }
  // REQUIRES: index < size(), here and below.
  const Sensor& sensor(std::size_t index) const { return *sensors_[index]; }

  // Lets Update measure the sensor.
  void Subscribe(std::size_t index) { subscribed_[index] = true; }
  bool IsSubscribed(std::size_t index) const { return subscribed_[index]; }

  // Copies the subscriptions and readings of another suite of the same robot.
  void CopyReadings(const SensorSuite& other);

  // Measures the subscribed sensors that are due at `tick`; the others keep their readings.
  void Update(const SensedWorld& world, Tick tick);
  // By sensor; empty where not subscribed or never due.
  std::span<const SensorReading> readings() const { return readings_; }

  // The reading of any sensor at `tick`, without effect on readings(). Valid until the next call of this or of Update.
  // REQUIRES: `world` is at the state of the last Update if that had the same tick.
  const SensorReading& Measure(std::size_t index, const SensedWorld& world, Tick tick);

 private:
  std::vector<std::unique_ptr<const Sensor>> sensors_;
  std::vector<bool> subscribed_;         // by sensor
  std::vector<SensorReading> readings_;  // by sensor
  SensorReading unsubscribed_;           // the last one of a sensor without a subscription, or between its periods
};

}  // namespace troupe
