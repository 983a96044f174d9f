// Measures one ranger of a robot in a small world, at the poses as loaded.
#pragma once

#include "common/sensing/sensor_suite.h"
#include "tests/support/small_world.h"
#include "troupe/world_state.h"

namespace troupe {

inline SensorReading MeasureSensor(const WorldDescription& world, const WorldState& state, RobotId robot,
                                   std::size_t sensor = 0) {
  const Scene scene(world);
  BodyIndex bodies(scene);
  bodies.Assign(state);
  return MakeSensors(scene, robot).at(sensor)->Measure({scene, bodies, &state}, state.tick);
}

inline RangerReading Measure(const WorldDescription& world, const WorldState& state, RobotId robot,
                             std::size_t ranger = 0) {
  return std::get<RangerReading>(MeasureSensor(world, state, robot, ranger).content);
}

inline RangerReading Measure(const WorldDescription& world, RobotId robot, std::size_t ranger = 0) {
  return Measure(world, PlacedState(world), robot, ranger);
}

}  // namespace troupe
