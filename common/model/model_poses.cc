#include "common/model/model_poses.h"

#include "troupe/check.h"

namespace troupe {

Pose JointMotion(const JointDescription& joint, double q) {
  if (joint.type == JointType::kRevolute) return {0.0, 0.0, 0.0, q};
  return {q * joint.axis_xy.x(), q * joint.axis_xy.y(), q * joint.axis_z, 0.0};
}

std::vector<Pose> ModelPoses(const WorldDescription& world, const WorldState& state) {
  TROUPE_CHECK(state.robots.size() == world.robots.size() && state.joints.size() == world.joints.size() &&
               state.objects.size() == world.objects.size());
  std::vector<Pose> X_PM;
  X_PM.reserve(world.models.size());
  for (const ModelDescription& model : world.models) X_PM.push_back(model.X_PM);
  for (std::size_t i = 0; i < world.robots.size(); ++i) X_PM[world.robots[i].root.index()] = state.robots[i].X_WR;
  for (std::size_t i = 0; i < world.objects.size(); ++i) X_PM[world.objects[i].index()] = state.objects[i].X_WO;
  for (std::size_t i = 0; i < world.joints.size(); ++i) {
    Pose& X = X_PM[world.joints[i].model.index()];
    X = X * JointMotion(world.joints[i], state.joints[i].position);
  }
  // Now from poses in parents to poses in W, parents first.
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const std::optional<ModelId>& parent = world.models[i].parent;
    if (parent) X_PM[i] = X_PM[parent->index()] * X_PM[i];
  }
  return X_PM;
}

}  // namespace troupe
