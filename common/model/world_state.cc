#include "common/model/world_state.h"

namespace troupe {

WorldState InitialState(const WorldDescription& world) {
  WorldState state;
  state.robots.reserve(world.robots.size());
  for (const RobotDescription& robot : world.robots) {
    state.robots.push_back({.X_WR = world.model(robot.root).X_PM, .twist = {}, .stalled = false});
  }
  return state;
}

}  // namespace troupe
