#include "robot-agent/agent/replica.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/model/check_state.h"

namespace troupe {
namespace {

Result<std::vector<RobotId>> FindRobots(const WorldDescription& world, const std::vector<std::string>& names) {
  std::vector<RobotId> ids;
  if (names.empty()) {
    for (std::size_t i = 0; i < world.robots.size(); ++i) ids.emplace_back(i);
    return ids;
  }
  for (const std::string& name : names) {
    const std::optional<RobotId> id = FindRobot(world, name);
    if (!id) {
      std::string known;
      for (std::size_t i = 0; i < world.robots.size() && i < 10; ++i) known += (i ? ", " : "") + world.robots[i].name;
      if (world.robots.size() > 10) known += fmt::format(", ... ({} in all)", world.robots.size());
      return Error{{}, fmt::format("the world has no robot '{}', expected one of: {}", name, known)};
    }
    if (std::find(ids.begin(), ids.end(), *id) != ids.end()) {
      return Error{{}, fmt::format("robot '{}' is named twice", name)};
    }
    ids.push_back(*id);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace

Result<std::unique_ptr<Replica>> Replica::Create(WorldDescription world, const std::vector<std::string>& robots,
                                                 ScanLog* scan_log) {
  Result<std::vector<RobotId>> ids = FindRobots(world, robots);
  if (!ids.ok()) return ids.error();
  std::unique_ptr<Replica> replica(new Replica(std::move(world)));
  for (RobotId id : ids.value()) {
    Result<std::unique_ptr<Robot>> robot = Robot::Create(replica->scene_, id, scan_log);
    if (!robot.ok()) return robot.error();
    replica->robots_.push_back(std::move(robot).value());
  }
  return replica;
}

std::vector<std::string> Replica::RobotNames() const {
  std::vector<std::string> names;
  for (const auto& robot : robots_) names.push_back(scene_.world().robot(robot->id()).name);
  return names;
}

std::string Replica::CheckState(const WorldState& state) const {
  return troupe::CheckState(scene_.world(), state);
}

void Replica::Answer(const WorldState& state, ProposalMessage& answer) {
  index_.Assign(state);
  answer.tick = state.tick + 1;
  answer.proposals.clear();
  answer.reports.clear();
  for (const auto& robot : robots_) {
    const bool worked = robot->failure().empty();
    answer.proposals.push_back(robot->Decide(state, index_));
    if (worked && !robot->failure().empty()) answer.reports.push_back(robot->failure());
  }
}

}  // namespace troupe
