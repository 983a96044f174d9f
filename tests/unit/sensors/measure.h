// Measures one ranger of a robot in a small world, at the poses as loaded.
#pragma once

#include "common/model/world_state.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "robot-agent/sensors/ranger.h"
#include "tests/support/small_world.h"

namespace troupe {

inline RangerReading Measure(const WorldDescription& world, const WorldState& state, RobotId robot,
                             std::size_t ranger = 0) {
  const Scene scene(world);
  BodyIndex index(scene);
  index.Assign(state);
  RangerReading reading;
  MeasureRanger(scene, index, robot, ranger, state.tick, reading);
  return reading;
}

inline RangerReading Measure(const WorldDescription& world, RobotId robot, std::size_t ranger = 0) {
  return Measure(world, InitialState(world), robot, ranger);
}

}  // namespace troupe
