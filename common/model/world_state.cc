#include "troupe/world_state.h"

namespace troupe {

WorldState PlacedState(const WorldDescription& world) {
  WorldState state;
  state.robots.reserve(world.robots.size());
  for (const RobotDescription& robot : world.robots) {
    state.robots.push_back({.X_WR = world.model(robot.root).X_PM, .twist = {}, .stalled = false});
  }
  for (const JointDescription& joint : world.joints) state.joints.push_back({.position = joint.start});
  state.grippers.resize(world.grippers.size());
  for (ModelId object : world.objects) state.objects.push_back({.X_WO = world.model(object).X_PM});
  for (ModelId store : FindStores(world)) state.stores.push_back({.joules = world.model(store).power.joules});
  state.imus.resize(FindImus(world).size());
  for (const LightPlace& light : FindLights(world)) {
    state.lights.push_back({world.model(light.model).blinking.is_switched_on});
  }
  state.cameras.resize(FindCameras(world).size());
  return state;
}

std::size_t MemoryOf(const WorldState& state) {
  std::size_t size = sizeof state;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    size += table.Of(state).size() * sizeof(Row);
  });
  for (const RadioTransmission& transmission : state.transmissions) size += transmission.message.bytes.size();
  return size;
}

}  // namespace troupe
