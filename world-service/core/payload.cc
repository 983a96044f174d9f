#include "world-service/core/payload.h"

#include <algorithm>

namespace troupe {

Payload FindPayload(const StepWorkspace& workspace, const std::function<bool(ModelId)>& moves) {
  const std::vector<ObjectState>& objects = workspace.next.objects;
  Payload payload;
  std::vector<bool> carried(objects.size(), false);
  for (const ObjectId id : workspace.objects) {
    const std::optional<GripperId>& holder = objects[id.index()].holder;
    if (!holder || !moves(workspace.world().gripper(*holder).model)) continue;
    carried[id.index()] = true;
    payload.held.push_back(id);
  }
  // Stacks grow from the bottom; each round adds the objects that rest on those of the one before.
  for (bool grown = true; grown;) {
    grown = false;
    for (const ObjectId id : workspace.objects) {
      if (carried[id.index()] || !objects[id.index()].support) continue;
      const ModelId support = *objects[id.index()].support;
      const std::optional<ObjectId> below = workspace.scene.object_of(support);
      if (below ? !carried[below->index()] : !moves(support)) continue;
      carried[id.index()] = true;
      grown = true;
      payload.stacked.push_back(id);
    }
  }
  std::sort(payload.stacked.begin(), payload.stacked.end());
  return payload;
}

void MoveObjects(StepWorkspace& workspace, const std::vector<ObjectId>& objects, const Pose& X_WF_before,
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
