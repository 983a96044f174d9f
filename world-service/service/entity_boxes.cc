#include "world-service/service/entity_boxes.h"

#include <algorithm>
#include <limits>
#include <map>
#include <string>

#include "common/model/model_poses.h"

namespace troupe {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

EntityBox NoBox() {
  return {kInfinity, kInfinity, kInfinity, -kInfinity, -kInfinity, -kInfinity};
}

void Extend(EntityBox& box, const Pose& X_EM, const Vec2& point, const ZRange& z) {
  const Vec2 p = Transform2(X_EM) * point;
  box.min_x = std::min(box.min_x, p.x());
  box.min_y = std::min(box.min_y, p.y());
  box.max_x = std::max(box.max_x, p.x());
  box.max_y = std::max(box.max_y, p.y());
  box.min_z = std::min(box.min_z, X_EM.z + z.min);
  box.max_z = std::max(box.max_z, X_EM.z + z.max);
}

void Extend(EntityBox& box, const Pose& X_EM, const Rectangle& r, const ZRange& z) {
  for (const Vec2& corner :
       {Vec2(r.min_x, r.min_y), Vec2(r.max_x, r.min_y), Vec2(r.max_x, r.max_y), Vec2(r.min_x, r.max_y)}) {
    Extend(box, X_EM, corner, z);
  }
}

void Extend(EntityBox& box, const Pose& X_EM, const Shape& shape) {
  for (const Block& block : shape.blocks) {
    for (const Vec2& corner : block.outline) Extend(box, X_EM, corner, block.z);
  }
  for (const Rectangle& rectangle : shape.rectangles) Extend(box, X_EM, rectangle, shape.rectangles_z);
  if (shape.area) Extend(box, X_EM * shape.area->X_MA(), shape.area->bounds(), shape.rectangles_z);
}

}  // namespace

void SetBoxes(const WorldDescription& world, const WorldState& state, std::vector<EntityReport>& entities) {
  std::map<std::string, EntityReport*> by_name;
  for (EntityReport& entity : entities) {
    entity.box = NoBox();
    by_name[entity.name] = &entity;
  }
  const std::vector<Pose> X_WM = ModelPoses(world, state);
  std::vector<EntityReport*> owners(world.models.size(), nullptr);  // of each model, by its root
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    if (model.removed) continue;
    if (model.parent) {
      owners[i] = owners[model.parent->index()];
    } else if (const auto found = by_name.find(model.name); found != by_name.end()) {
      owners[i] = found->second;
    }
    if (owners[i] == nullptr) continue;
    Extend(owners[i]->box, Inverse(owners[i]->X_WE) * X_WM[i], world.shape(model.shape));
  }
  for (EntityReport& entity : entities) {
    if (entity.box.min_x > entity.box.max_x) entity.box = {};
  }
}

}  // namespace troupe
