#include "robot-agent/agent/replica.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <iterator>
#include <mutex>
#include <utility>

#include "common/model/find_robots.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxNamed = 10;  // robots, in an error

// With fewer robots a thread costs more in hand-overs than it saves.
constexpr std::size_t kRobotsPerThread = 16;
// Robots that a thread claims at a time.
constexpr std::size_t kShare = 4;

Result<std::vector<RobotId>> RobotsNamed(const WorldDescription& world, const std::vector<std::string>& names) {
  std::vector<RobotId> ids;
  if (names.empty()) {
    for (std::size_t i = 0; i < world.robots.size(); ++i) {
      if (RobotExists(world, RobotId(i))) ids.emplace_back(i);
    }
    return ids;
  }
  const std::vector<std::optional<RobotId>> found = FindRobots(world, names);
  std::vector<bool> is_named(world.robots.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string& name = names[i];
    const std::optional<RobotId>& id = found[i];
    if (!id) {
      std::vector<std::string> known;
      for (std::size_t k = 0; k < world.robots.size(); ++k) {
        if (RobotExists(world, RobotId(k))) known.push_back(world.robots[k].name);
      }
      if (known.size() > kMaxNamed) known[kMaxNamed] = fmt::format("... ({} in all)", known.size());
      known.resize(std::min(known.size(), kMaxNamed + 1));
      return Error{{}, fmt::format("the world has no robot '{}', expected one of: {}", name, fmt::join(known, ", "))};
    }
    if (is_named[id->index()]) return Error{{}, fmt::format("robot '{}' is named twice", name)};
    is_named[id->index()] = true;
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

// What robots report in a tick, from several threads.
class ReportsOfRobots {
 public:
  void Add(std::size_t robot, const std::string& text) {
    const std::lock_guard lock(mutex_);
    reports_.emplace_back(robot, text);
  }
  // In the order of robots, and of their reports.
  void MoveTo(std::vector<std::string>& texts) {
    std::stable_sort(reports_.begin(), reports_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto& [robot, text] : reports_) texts.push_back(std::move(text));
  }

 private:
  std::mutex mutex_;
  std::vector<std::pair<std::size_t, std::string>> reports_;
};

class View final : public RobotView {
 public:
  View(Robot& robot, const WorldState& state, const BodyIndex& bodies)
      : robot_(robot), state_(state), bodies_(bodies) {}

  RobotId id() const override { return robot_.id(); }
  const RobotState& state() const override { return state_.robots[robot_.id().index()]; }
  const WorldState& world_state() const override { return state_; }
  const Pose& pose_estimate() const override { return robot_.pose_estimate(); }
  const SensorReading& Measure(std::size_t sensor) const override { return robot_.Measure(sensor, state_, bodies_); }

 private:
  Robot& robot_;
  const WorldState& state_;
  const BodyIndex& bodies_;
};

}  // namespace

Result<std::unique_ptr<Replica>> Replica::Create(std::shared_ptr<const Scene> scene,
                                                 const std::vector<std::string>& robots, const RobotOptions& options,
                                                 std::shared_ptr<ThreadPool> pool, const MakeGateway& make_gateway,
                                                 TickTrace* trace) {
  const Result<std::vector<RobotId>> ids = RobotsNamed(scene->world(), robots);
  if (!ids.ok()) return ids.error();
  std::unique_ptr<Replica> replica(new Replica(std::move(scene), options, make_gateway));
  if (Status status = replica->MakeRobots(ids.value()); !status.ok()) return status.error();
  // Lines of a scan log are in the order of robots: one thread.
  const std::size_t most = pool != nullptr && options.scan_log == nullptr ? pool->size() : 1;
  // The number of threads changes no result: each robot decides from the same state, into its own place.
  const std::size_t threads = std::clamp<std::size_t>(replica->robots_.size() / kRobotsPerThread, 1, most);
  replica->ResetIndices(threads);
  if (threads > 1) replica->pool_ = std::move(pool);
  for (std::size_t i = 0; i < threads; ++i) replica->lanes_.push_back(trace != nullptr ? trace->AddLane() : nullptr);
  replica->trace_ = trace;
  replica->NameRobotsInTrace();
  if (Status status = replica->MakeNewGateway(); !status.ok()) return status.error();
  return replica;
}

Status Replica::MakeRobots(const std::vector<RobotId>& ids) {
  robots_.clear();
  robots_scenes_ = {scene_};
  // By id, so that all lists of the replica are in the order of a proposal message.
  for (const RobotId id : ids) {
    Result<std::unique_ptr<Robot>> robot = Robot::Create(*scene_, id, options_);
    if (!robot.ok()) return robot.error();
    robots_.push_back(std::move(robot).value());
  }
  return {};
}

void Replica::ResetIndices(std::size_t threads) {
  indices_.assign(threads, BodyIndex(*scene_));
}

void Replica::NameRobotsInTrace() {
  if (trace_ != nullptr) trace_->NameRobots(RobotNamesOf(scene_->world()));
}

Status Replica::MakeNewGateway() {
  gateway_.reset();  // first, because the next one may use the same names
  gateway_scene_ = scene_;
  if (!make_gateway_ || robots_.empty()) return {};
  try {
    gateway_ = make_gateway_(*scene_, Ids());
    return {};
  } catch (const std::exception& exception) {
    return FailureOf(exception);
  }
}

Status Replica::ChangeWorld(std::shared_ptr<const Scene> scene, bool fresh, Edition edition) {
  const WorldDescription& world = scene->world();
  const std::vector<RobotId> before = Ids();
  std::vector<RobotId> ids;
  if (fresh) {
    for (const std::optional<RobotId>& found : FindRobots(world, RobotNames())) {
      if (found) ids.push_back(*found);
    }
  } else {
    std::copy_if(before.begin(), before.end(), std::back_inserter(ids),
                 [&](RobotId id) { return RobotExists(world, id); });
  }
  std::sort(ids.begin(), ids.end());
  // Alive until FollowWorld has compared the controllers.
  const std::shared_ptr<const Scene> before_scene = scene_;
  scene_ = std::move(scene);
  ResetIndices(indices_.size());
  NameRobotsInTrace();
  if (fresh) {
    if (options_.scan_log != nullptr) options_.scan_log->Restart(edition);
    if (Status status = MakeRobots(ids); !status.ok()) return status;
  } else {
    std::erase_if(robots_, [&](const auto& robot) { return !RobotExists(scene_->world(), robot->id()); });
    if (Status status = FollowWorld(*before_scene); !status.ok()) return status;
  }
  if (gateway_ == nullptr) return {};
  if (ids != before || !GatewayFits(fresh)) return MakeNewGateway();
  gateway_->ChangeWorld(*scene_);
  shown_scene_ = scene_;
  if (fresh) gateway_->Restart();
  return {};
}

Status Replica::FollowWorld(const Scene& before) {
  for (std::unique_ptr<Robot>& robot : robots_) {
    const RobotId id = robot->id();
    if (before.world().robot(id).controller == scene_->world().robot(id).controller) {
      robot->ChangeWorld(*scene_);
      continue;
    }
    Result<std::unique_ptr<Robot>> made = Robot::Create(*scene_, id, options_);
    if (!made.ok()) return made.error();
    robot = std::move(made).value();
    if (robots_scenes_.back() != scene_) robots_scenes_.push_back(scene_);
  }
  return {};
}

Status Replica::AddRobots(const std::vector<std::string>& names) {
  const std::vector<RobotId> before = Ids();
  for (const std::optional<RobotId>& id : FindRobots(scene_->world(), names)) {
    if (!id || std::binary_search(before.begin(), before.end(), *id)) continue;
    Result<std::unique_ptr<Robot>> robot = Robot::Create(*scene_, *id, options_);
    if (!robot.ok()) return robot.error();
    robots_.push_back(std::move(robot).value());
  }
  if (robots_.size() == before.size()) return {};
  robots_scenes_.push_back(scene_);
  std::sort(robots_.begin(), robots_.end(), [](const auto& a, const auto& b) { return a->id() < b->id(); });
  return MakeNewGateway();
}

Status Replica::RemoveRobots(const std::set<std::string>& names) {
  const std::size_t removed = std::erase_if(
      robots_, [&](const auto& robot) { return names.contains(scene_->world().robot(robot->id()).name); });
  return removed > 0 ? MakeNewGateway() : Status();
}

Status Replica::Renew(Edition edition) {
  if (options_.scan_log != nullptr) options_.scan_log->Restart(edition);
  if (Status status = MakeRobots(Ids()); !status.ok()) return status;
  if (gateway_ == nullptr) return {};
  if (!GatewayFits(true)) return MakeNewGateway();
  gateway_->Restart();
  return {};
}

bool Replica::GatewayFits(bool fresh) const {
  const WorldDescription& now = scene_->world();
  const WorldDescription& then = gateway_scene_->world();
  const bool grips = std::any_of(robots_.begin(), robots_.end(),
                                 [&](const auto& robot) { return !scene_->grippers_of(robot->id()).empty(); });
  // A gripper's action takes many ticks, and its topics name all objects.
  if (grips && (fresh || now.objects != then.objects || now.models.size() != then.models.size())) return false;
  if (!fresh) return true;
  return now.name == then.name && now.interval_ns == then.interval_ns && now.robots == then.robots &&
         now.joints == then.joints && now.grippers == then.grippers && now.objects == then.objects &&
         now.models.size() == then.models.size();
}

std::vector<RobotId> Replica::Ids() const {
  std::vector<RobotId> ids;
  for (const auto& robot : robots_) ids.push_back(robot->id());
  return ids;
}

std::vector<std::string> Replica::RobotNames() const {
  std::vector<std::string> names;
  for (const auto& robot : robots_) names.push_back(scene_->world().robot(robot->id()).name);
  return names;
}

Status Replica::CheckState(const WorldState& state) const {
  const Status status = scene_->CheckState(state);
  return status.ok() ? status : Failure(status.error().message);
}

void Replica::Relocate(const WorldState& state) {
  for (const auto& robot : robots_) robot->Relocate(state);
}

std::vector<std::string> Replica::NamesThatAcceptGoals() const {
  std::vector<std::string> names;
  for (const auto& robot : robots_) {
    if (robot->accepts_goals()) names.push_back(scene_->world().robot(robot->id()).name);
  }
  return names;
}

// Both are in robot-id order.
void Replica::AddCommands(std::span<const RobotCommand> commands, std::span<ExternalCommand> external,
                          std::vector<std::string>& reports) const {
  const WorldDescription& world = scene_->world();
  auto command = commands.begin();
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const RobotId id = robots_[i]->id();
    while (command != commands.end() && command->robot < id) ++command;
    if (command == commands.end() || command->robot != id) continue;
    if (Status failure = CheckRobotCommand(world, *command); !failure.ok()) {
      reports.push_back(failure.error().message);
    } else {
      AddCommand(*command, world.robot(id).drive, external[i]);
    }
  }
}

ProposalMessage Replica::Decide(const WorldState& state, std::span<const RobotCommand> commands,
                                std::vector<Proposal> memory) {
  const std::size_t count = robots_.size();
  ProposalMessage answer;
  answer.tick = state.tick + 1;
  answer.proposals = std::move(memory);
  answer.proposals.resize(count);
  // Before the threads: a gateway need not be safe for several.
  // An empty list in most ticks: nothing to allocate for a swarm without commands.
  std::vector<ExternalCommand> external(gateway_ || !commands.empty() ? count : 0);
  for (std::size_t i = 0; i < count && gateway_; ++i) external[i] = gateway_->CommandFor(robots_[i]->id(), state);
  if (!commands.empty()) AddCommands(commands, external, answer.reports);
  const ExternalCommand none;
  ReportsOfRobots reports;
  DecideAll(state, [&](Robot& robot, std::size_t i, const BodyIndex& bodies, TraceLane* lane) {
    // A failure is reported in the tick in which it happens, and not again.
    const bool worked = robot.failure().empty();
    answer.proposals[i] = robot.Decide(state, bodies, external.empty() ? none : external[i], lane);
    if (worked && !robot.failure().empty()) reports.Add(i, robot.failure());
    if (!robot.report().empty()) reports.Add(i, robot.report());
  });
  reports.MoveTo(answer.reports);
  if (!gateway_) return answer;
  for (std::string& report : gateway_->DrainReports()) answer.reports.push_back(std::move(report));
  return answer;
}

std::vector<Proposal> Replica::Retrace(const WorldState& state, std::span<const RobotCommand> commands) {
  std::vector<Proposal> proposals(robots_.size());
  std::vector<ExternalCommand> external(robots_.size());
  std::vector<std::string> reported;  // when the run was there
  if (!commands.empty()) AddCommands(commands, external, reported);
  DecideAll(state, [&](Robot& robot, std::size_t i, const BodyIndex& bodies, TraceLane*) {
    proposals[i] = robot.Retrace(state, bodies, external[i]);
  });
  return proposals;
}

// Threads claim robots as they become free. The first index follows the state in any case: Publish reads it.
template <typename DecideOne>
void Replica::DecideAll(const WorldState& state, const DecideOne& decide) {
  std::atomic<std::size_t> next = 0;  // the first robot that no thread has claimed
  const auto decide_share = [&](std::size_t thread) {
    if (thread != 0 && next >= robots_.size()) return;
    BodyIndex& bodies = indices_[thread];
    Enter(lanes_[thread], TickPhase::kApply, state.tick + 1);
    // Each thread has an index of its own, because an index computes poses when they are first read.
    bodies.Assign(state);
    for (std::size_t first = next.fetch_add(kShare); first < robots_.size(); first = next.fetch_add(kShare)) {
      const std::size_t end = std::min(first + kShare, robots_.size());
      for (std::size_t i = first; i < end; ++i) {
        if (i + 1 < end) robots_[i + 1]->Prefetch();
        decide(*robots_[i], i, bodies, lanes_[thread]);
      }
    }
    if (lanes_[thread] != nullptr) lanes_[thread]->Leave();
  };
  if (pool_) {
    pool_->Run(indices_.size(), decide_share);
  } else {
    decide_share(0);
  }
}

ProposalMessage Replica::Pause(const WorldState& state) {
  indices_.front().Assign(state);
  for (const auto& robot : robots_) robot->UpdateOdometry(state);
  ProposalMessage answer;
  answer.tick = state.tick + 1;
  answer.paused = true;
  return answer;
}

void Replica::Publish(const WorldState& state) {
  Show(state, &Gateway::Publish);
}

void Replica::AwaitPublished() {
  if (gateway_) gateway_->AwaitPublished();
}

void Replica::Repeat(const WorldState& state) {
  Show(state, &Gateway::Repeat);
}

void Replica::Show(const WorldState& state, void (Gateway::*show)(Tick, std::span<const RobotView* const>)) {
  if (!gateway_) return;
  std::vector<View> views;
  views.reserve(robots_.size());
  for (const auto& robot : robots_) views.emplace_back(*robot, state, indices_.front());
  std::vector<const RobotView*> robots;
  for (const View& view : views) robots.push_back(&view);
  (gateway_.get()->*show)(state.tick, robots);
}

}  // namespace troupe
