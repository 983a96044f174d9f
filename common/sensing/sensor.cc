#include "common/sensing/sensor.h"

namespace troupe {

Sensor::Sensor(const SensorMount& mount) : robot_(mount.robot), index_(mount.index), description_(mount.description) {}

SensorReading Sensor::Measure(const SensedWorld& world, Tick tick) const {
  SensorReading reading;
  MeasureInto(world, tick, reading);
  return reading;
}

}  // namespace troupe
