#include "robot-agent/agent/replica.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/model/check_state.h"

namespace troupe {
namespace {

// Robots for which a thread of their own is worth its hand-offs.
constexpr std::size_t kRobotsPerThread = 16;

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
                                                 ScanLog* scan_log, std::size_t threads) {
  Result<std::vector<RobotId>> ids = FindRobots(world, robots);
  if (!ids.ok()) return ids.error();
  std::unique_ptr<Replica> replica(new Replica(std::move(world)));
  for (RobotId id : ids.value()) {
    Result<std::unique_ptr<Robot>> robot = Robot::Create(replica->scene_, id, scan_log);
    if (!robot.ok()) return robot.error();
    replica->robots_.push_back(std::move(robot).value());
  }
  if (scan_log != nullptr) threads = 1;
  threads = std::clamp<std::size_t>(replica->robots_.size() / kRobotsPerThread, 1, threads);
  replica->indices_.assign(threads, BodyIndex(replica->scene_));
  if (threads > 1) replica->crew_.emplace(threads);
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
  const std::size_t count = robots_.size();
  answer.tick = state.tick + 1;
  answer.proposals.resize(count);
  answer.reports.clear();
  std::vector<bool> worked;
  for (const auto& robot : robots_) worked.push_back(robot->failure().empty());
  const auto decide = [&](std::size_t thread) {
    BodyIndex& bodies = indices_[thread];
    bodies.Assign(state);
    const std::size_t end = count * (thread + 1) / indices_.size();
    for (std::size_t i = count * thread / indices_.size(); i < end; ++i) {
      answer.proposals[i] = robots_[i]->Decide(state, bodies);
    }
  };
  if (crew_) {
    crew_->Run(decide);
  } else {
    decide(0);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (worked[i] && !robots_[i]->failure().empty()) answer.reports.push_back(robots_[i]->failure());
  }
}

}  // namespace troupe
