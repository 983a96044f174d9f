#include "world-service/core/load.h"

#include <algorithm>

namespace troupe {

Load FindLoad(const StepWorkspace& workspace, const std::function<bool(ModelId)>& moves) {
  const std::vector<ObjectState>& objects = workspace.next.objects;
  Load load;
  std::vector<bool> goes(objects.size(), false);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!objects[i].holder || !moves(workspace.world().gripper(*objects[i].holder).model)) continue;
    goes[i] = true;
    load.held.push_back(ObjectId(i));
  }
  // Stacks grow from the bottom; each round adds what stands on the one before.
  for (bool grown = true; grown;) {
    grown = false;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (goes[i] || !objects[i].support) continue;
      const ModelId support = *objects[i].support;
      const std::optional<ObjectId> below = workspace.scene.object_of(support);
      if (below ? !goes[below->index()] : !moves(support)) continue;
      goes[i] = true;
      grown = true;
      load.stacked.push_back(ObjectId(i));
    }
  }
  std::sort(load.stacked.begin(), load.stacked.end());
  return load;
}

void Carry(StepWorkspace& workspace, const std::vector<ObjectId>& objects, const Pose& X_WF_before,
           const Pose& X_WF_after, double dz) {
  const Pose X_FW = Inverse(X_WF_before);
  const bool shifted =
      X_WF_before.x != X_WF_after.x || X_WF_before.y != X_WF_after.y || X_WF_before.heading != X_WF_after.heading;
  for (ObjectId object : objects) {
    const Pose before = workspace.next.objects[object.index()].X_WO;
    Pose after = shifted ? X_WF_after * (X_FW * before) : before;
    after.z = before.z + dz;
    workspace.MoveObject(object, after);
  }
}

}  // namespace troupe
