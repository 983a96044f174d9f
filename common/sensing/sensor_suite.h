// SensorSuite: all sensors of one robot with the last readings of the subscribed sensors.
//
// An agent measures what its controller reads and nothing else: rays and images are costly. A reading without a
// subscription is measured on demand and kept for repeated questions of one tick only.
//
// The order of the sensors is that of the description, then the break beams of grippers; the index is part of the keys
// of noise, so that it must not depend on subscriptions.
//
// Threads: one at a time.
#pragma once

#include <memory>
#include <span>
#include <string_view>
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

  // Fetches the memory of the sensors and readings, for an Update soon (common/base/prefetch.h).
  void Prefetch() const;
  // Measures the subscribed sensors that are due at `tick`; the others keep their readings.
  void Update(const SensedWorld& world, Tick tick);
  // The reading of each sensor; empty where not subscribed or never due.
  std::span<const SensorReading> readings() const { return readings_; }

  // The reading of any sensor at `tick`, without effect on readings(). Valid until the next call of this or of Update.
  // REQUIRES: `world` is at the state of the last Update if that had the same tick.
  const SensorReading& Measure(std::size_t index, const SensedWorld& world, Tick tick);

 private:
  std::vector<std::unique_ptr<const Sensor>> sensors_;
  std::vector<bool> subscribed_;         // by sensor
  std::vector<SensorReading> readings_;  // by sensor
  std::size_t unsubscribed_sensor_ = 0;  // of the next
  SensorReading unsubscribed_;           // the last one of a sensor without a subscription, or between its periods
};

// The kinds of sensors by their type names, and the sensors of a robot.

struct SensorKind {
  std::string_view type;  // as TypeOf
  // REQUIRES: the mount's description is of this type.
  std::unique_ptr<const Sensor> (*make)(const SensorMount& mount);
};

std::span<const SensorKind> SensorKinds();

// Null for an unknown type.
const SensorKind* FindSensorKind(std::string_view type);

// The descriptions of all sensors of a robot: RobotDescription::sensors with their indices, then one for the
// break beams of each of its grippers that has any, in id order, named "<gripper>.beams".
std::vector<SensorDescription> MountedSensors(const Scene& scene, RobotId robot);

// A sensor for each description of MountedSensors.
std::vector<std::unique_ptr<const Sensor>> MakeSensors(const Scene& scene, RobotId robot);

}  // namespace troupe
