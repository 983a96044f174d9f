#include "world-service/service/entities.h"

#include <map>
#include <set>

namespace troupe {

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

}  // namespace troupe
