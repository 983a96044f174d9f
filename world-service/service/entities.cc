#include "world-service/service/entities.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
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

std::vector<EntityReport> ListEntities(const WorldDescription& world, const WorldState& state) {
  std::vector<EntityReport> entities(world.models.size());
  for (std::size_t i = 0; i < entities.size(); ++i) {
    const ModelDescription& model = world.models[i];
    entities[i] = {.name = model.name, .type = model.type, .kind = EntityKind::kModel, .X_WE = model.X_PM};
  }
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    EntityReport& entity = entities[world.robots[i].root.index()];
    entity.kind = EntityKind::kRobot;
    entity.X_WE = state.robots[i].X_WR;
    entity.twist = state.robots[i].twist;
  }
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    EntityReport& entity = entities[world.objects[i].index()];
    entity.kind = EntityKind::kObject;
    entity.X_WE = state.objects[i].X_WO;
  }
  std::vector<EntityReport> listed;
  for (std::size_t i = 0; i < entities.size(); ++i) {
    if (!world.models[i].parent && !world.models[i].removed) listed.push_back(std::move(entities[i]));
  }
  return listed;
}

void SetAgents(const WorldDescription& world, const Membership& members, std::vector<EntityReport>& entities) {
  std::map<std::string, RobotId> robots;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (IsThere(world, RobotId(i))) robots.emplace(world.robots[i].name, RobotId(i));
  }
  const std::vector<Membership::Waits> waits = members.WaitsOfRobots();
  for (EntityReport& entity : entities) {
    const auto robot = robots.find(entity.name);
    const Member* const member = robot == robots.end() ? nullptr : members.MemberOf(robot->second);
    if (member == nullptr) continue;
    entity.agent = AgentReport{member->host, member->pid, member->present, member->answer_seconds,
                               waits[robot->second.index()].times_last};
  }
}

std::string FreeName(const WorldDescription& world, const std::string& base) {
  std::set<std::string> names;
  for (const ModelDescription& model : world.models) {
    if (!model.removed) names.insert(model.name);
  }
  if (!names.contains(base)) return base;
  for (std::size_t number = 0;; ++number) {
    std::string name = base + std::to_string(number);
    if (!names.contains(name)) return name;
  }
}

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
