#include "world-service/core/initial_state.h"

#include <utility>

#include "world-service/core/gravity.h"
#include "world-service/core/step_workspace.h"

namespace troupe {

WorldState InitialState(const Scene& scene) {
  WorldState placed = PlacedState(scene.world());
  if (placed.objects.empty()) return placed;
  StepMemory memory(scene, placed);
  StepWorkspace workspace(scene, memory);
  FindSupports(workspace);
  return std::move(memory.next);
}

}  // namespace troupe
