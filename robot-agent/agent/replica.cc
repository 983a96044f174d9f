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

std::vector<std::string> RobotNamesOf(const WorldDescription& world) {
  std::vector<std::string> names;
  for (const RobotDescription& robot : world.robots) names.push_back(robot.name);
  return names;
}

class View final : public RobotView {
 public:
  View(Robot& robot, const WorldState& state, const BodyIndex& bodies)
      : robot_(robot), state_(state), bodies_(bodies) {}

  RobotId id() const override { return robot_.id(); }
  const RobotState& state() const override { return state_.robots[robot_.id().index()]; }
  const WorldState& world_state() const override { return state_; }
  const Pose& pose_estimate() const override { return robot_.pose_estimate(); }
  const RangerReading& Measure(std::size_t ranger) const override {
    return robot_.Measure(ranger, state_.tick, bodies_);
  }

 private:
  Robot& robot_;
  const WorldState& state_;
  const BodyIndex& bodies_;
};

}  // namespace

Result<std::unique_ptr<Replica>> Replica::Create(WorldDescription world, const std::vector<std::string>& robots,
                                                 ScanLog* scan_log, std::size_t threads,
                                                 const MakeGateway& make_gateway, TickTrace* trace) {
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
  for (std::size_t i = 0; i < threads; ++i) replica->lanes_.push_back(trace != nullptr ? trace->AddLane() : nullptr);
  if (trace != nullptr) trace->NameRobots(RobotNamesOf(replica->scene_.world()));
  if (make_gateway) replica->gateway_ = make_gateway(replica->scene_, ids.value());
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
  answer.held = false;
  // Before the robots are shared among threads: a gateway need not know of them.
  std::vector<OutsideCommand> outside(count);
  for (std::size_t i = 0; i < count && gateway_; ++i) outside[i] = gateway_->CommandFor(robots_[i]->id(), state.tick);
  std::vector<bool> worked;
  for (const auto& robot : robots_) worked.push_back(robot->failure().empty());
  const auto decide = [&](std::size_t thread) {
    BodyIndex& bodies = indices_[thread];
    Enter(lanes_[thread], TickPhase::kApply, answer.tick);
    bodies.Assign(state);
    const std::size_t end = count * (thread + 1) / indices_.size();
    for (std::size_t i = count * thread / indices_.size(); i < end; ++i) {
      answer.proposals[i] = robots_[i]->Decide(state, bodies, outside[i], lanes_[thread]);
    }
    if (lanes_[thread] != nullptr) lanes_[thread]->Leave();
  };
  if (crew_) {
    crew_->Run(decide);
  } else {
    decide(0);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (worked[i] && !robots_[i]->failure().empty()) answer.reports.push_back(robots_[i]->failure());
  }
  if (!gateway_) return;
  for (std::string& report : gateway_->TakeReports()) answer.reports.push_back(std::move(report));
}

void Replica::Hold(const WorldState& state, ProposalMessage& answer) {
  indices_.front().Assign(state);
  for (const auto& robot : robots_) robot->Observe(state);
  answer.tick = state.tick + 1;
  answer.proposals.clear();
  answer.reports.clear();
  answer.held = true;
}

void Replica::Publish(const WorldState& state) {
  if (!gateway_) return;
  std::vector<View> views;
  views.reserve(robots_.size());
  for (const auto& robot : robots_) views.emplace_back(*robot, state, indices_.front());
  std::vector<const RobotView*> robots;
  for (const View& view : views) robots.push_back(&view);
  gateway_->Publish(state.tick, robots);
}

}  // namespace troupe
