#include "tests/faults/reference_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/model/states.h"
#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"
#include "world-service/core/step.h"
#include "world-service/service/apply_edit.h"

namespace troupe::faults {
namespace {

// A radio that loses a few messages, with a delay or without.
void AddRadio(WorldDescription& world, RobotId robot, std::size_t index) {
  RadioParameters radio{.delay = 0.1 * static_cast<double>(index % 3), .loss = 0.2};
  test::AddSensor(world, robot, {0.0, 0.0, 0.4, 0.0}, radio);
}

void AddRobot(SmallWorld& world, const std::string& name, std::size_t index, bool memory) {
  const double angle = 1.7 * static_cast<double>(index);
  const RobotId robot = world.AddRobot(name, {1.2 * std::cos(angle), 1.2 * std::sin(angle), 0.0, 0.7 * angle});
  if (memory && index % 6 != 5 && index % 2 == 1) {
    AddRadio(world.world(), robot, index);
    return world.SetController(robot, kCountingController);
  }
  if (memory && index % 2 == 0) {
    world.AddRanger(robot, {}, {OneRay(2.0)});
    return world.SetController(robot, "wander");
  }
  const double speed = 0.2 + 0.1 * static_cast<double>(index % 4);
  world.SetController(
      robot, "script",
      fmt::format(
          R"({{"repeat": true, "period": 3, "commands": [{{"at": 0, "vx": {}}}, {{"at": {}, "vx": {}, "wz": 1}}]}})",
          speed, 1.1 + 0.2 * static_cast<double>(index % 3), -speed));
}

void AddObject(SmallWorld& world, const std::string& name, double x, double y) {
  world.AddBox(name, x, y, 0.3, 0.3, {0.0, 0.3}).gripper_return = true;
  world.world().objects.emplace_back(world.world().models.size() - 1);
}

WorldDescription Valid(const WorldDescription& world) {
  if (const Status status = Validate(world); !status.ok()) throw std::runtime_error(status.error().message);
  return world;
}

}  // namespace

ReferenceRun::ReferenceRun(std::shared_ptr<const Scene> scene, const FaultPlan& plan)
    : plan_(plan), original_(scene), scene_(std::move(scene)), state_(InitialState(*scene_)) {
  options_.libraries.Add(kCountingController);
  AddReplicas();
}

void ReferenceRun::AddReplicas() {
  const WorldDescription& world = scene_->world();
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const std::string& name = world.robots[i].name;
    if (!RobotExists(world, RobotId(i)) || replicas_.contains(name)) continue;
    Result<std::unique_ptr<Replica>> replica = Replica::Create(scene_, {name}, options_);
    if (!replica.ok()) throw std::runtime_error(replica.error().message);
    replicas_[name] = std::move(replica).value();
  }
}

Status ReferenceRun::OnTick(const CommittedTick& tick) {
  if (!difference_.empty()) return {};
  ++ticks_;
  if (tick.edit != nullptr) {
    Edit(tick);
  } else if (begun_) {
    Advance(tick);
  }
  begun_ = true;
  hash_ = StateHash(state_);
  hashes_[{tick.frame.edition, tick.frame.state.tick}] = hash_;
  edition_ = tick.frame.edition;
  if (state_.tick != tick.frame.state.tick) {
    Differ(tick, fmt::format("the tick without faults is {}", state_.tick));
  } else if (hash_ != tick.frame.state_hash) {
    Differ(tick, fmt::format("hash {:016x}, without faults {:016x}", tick.frame.state_hash, hash_));
  }
  return {};
}

std::optional<std::uint64_t> ReferenceRun::HashOf(Edition edition, Tick tick) const {
  const auto found = hashes_.find({edition, tick});
  return found == hashes_.end() ? std::nullopt : std::optional(found->second);
}

void ReferenceRun::Edit(const CommittedTick& tick) {
  Result<EditedWorld> edited = ApplyEdit(*tick.edit, original_, scene_, state_);
  if (!edited.ok()) return Differ(tick, "the edit cannot be applied: " + edited.error().message);
  EditedWorld& result = edited.value();
  if (control::Is<control::LoadWorld>(tick.edit->request)) original_ = result.scene;
  const bool new_world = result.scene != scene_;
  scene_ = result.scene;
  state_ = std::move(result.state);
  for (auto entry = replicas_.begin(); entry != replicas_.end();) {
    Replica& replica = *entry->second;
    Status status;
    if (new_world) {
      status = replica.ChangeWorld(scene_, result.fresh, tick.frame.edition);
    } else if (result.fresh) {
      status = replica.Renew(tick.frame.edition);
    }
    if (!status.ok()) return Differ(tick, status.error().message);
    if (replica.has_robots()) replica.Relocate(state_);
    entry = replica.has_robots() ? std::next(entry) : replicas_.erase(entry);
  }
  AddReplicas();
}

void ReferenceRun::Advance(const CommittedTick& tick) {
  std::vector<Proposal> proposals;
  for (const auto& [name, replica] : replicas_) {
    for (const Proposal& proposal : replica->Decide(state_).proposals) proposals.push_back(proposal);
  }
  std::sort(proposals.begin(), proposals.end(), [](const Proposal& a, const Proposal& b) { return a.robot < b.robot; });
  // The agent of a frozen robot is lost.
  const bool may_freeze = plan_.settings.on_agent_loss == OnAgentLoss::kFreeze && !plan_.gentle;
  if (may_freeze) {
    std::erase_if(proposals, [&](const Proposal& proposal) {
      return std::none_of(tick.proposals.begin(), tick.proposals.end(),
                          [&](const Proposal& sent) { return sent.robot == proposal.robot; });
    });
  }
  if (!std::equal(proposals.begin(), proposals.end(), tick.proposals.begin(), tick.proposals.end())) {
    return Differ(
        tick, fmt::format("{} proposals differ from the {} without faults", tick.proposals.size(), proposals.size()));
  }
  state_ = Step(*scene_, state_, proposals).state;
}

void ReferenceRun::Differ(const CommittedTick& tick, const std::string& what) {
  if (!difference_.empty()) return;
  difference_ = fmt::format("tick {} of edition {}: {}", tick.frame.state.tick, tick.frame.edition, what);
}

WorldDescription RunWorld(std::size_t robots, bool memory) {
  SmallWorld world;
  world.AddBox("box", 0.2, 0.1, 0.4, 0.4, {0.0, 0.5});
  AddObject(world, "crate", 2.5, 2.5);
  for (std::size_t i = 0; i < robots; ++i) AddRobot(world, "r" + std::to_string(i), i, memory);
  return Valid(world.world());
}

std::shared_ptr<const WorldDescription> OtherWorld(bool memory) {
  SmallWorld world;
  world.AddBox("box", -0.2, 0.3, 0.5, 0.3, {0.0, 0.5});
  AddRobot(world, "x0", 3, memory);
  AddRobot(world, "r1", 1, memory);
  AddRobot(world, "r0", 0, memory);
  return std::make_shared<const WorldDescription>(Valid(world.world()));
}

std::shared_ptr<const WorldDescription> WorldToSpawn(const std::string& source, bool memory) {
  SmallWorld world;
  if (source == "scout") AddRobot(world, "scout", 2, memory);
  if (source == "crate") AddObject(world, "crate", 0.0, 0.0);
  return std::make_shared<const WorldDescription>(Valid(world.world()));
}

}  // namespace troupe::faults
