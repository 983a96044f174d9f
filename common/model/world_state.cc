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
  std::size_t size = sizeof state + state.robots.size() * sizeof(RobotState) +
                     state.joints.size() * sizeof(JointState) + state.grippers.size() * sizeof(GripperState) +
                     state.objects.size() * sizeof(ObjectState) + state.stores.size() * sizeof(StoreState) +
                     state.imus.size() * sizeof(ImuState) + state.lights.size() * sizeof(LightState) +
                     state.cameras.size() * sizeof(CameraState);
  for (const RadioTransmission& transmission : state.transmissions) {
    size += sizeof transmission + transmission.message.bytes.size();
  }
  return size;
}

}  // namespace troupe
