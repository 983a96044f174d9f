// The check of a state that a peer sent.
#pragma once

#include <cstddef>

#include "troupe/result.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

// The rows of a state whose number follows from the whole world.
struct DeviceCounts {
  std::size_t stores = 0;
  std::size_t imus = 0;
  std::size_t lights = 0;
  std::size_t cameras = 0;
};
DeviceCounts CountDevices(const WorldDescription& world);

// Success if the state belongs to the world: as many robots, joints, grippers, objects and devices, finite numbers,
// known ids. REQUIRES: `devices` are those of the world
Status CheckState(const WorldDescription& world, const DeviceCounts& devices, const WorldState& state);
Status CheckState(const WorldDescription& world, const WorldState& state);

}  // namespace troupe
