#include "tests/faults/reference_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "common/model/states.h"
#include "tests/faults/small_worlds.h"
#include "world-service/core/step.h"
#include "world-service/service/apply_edit.h"

namespace troupe::faults {

ReferenceRun::ReferenceRun(std::shared_ptr<const Scene> scene, const FaultPlan& plan)
    : plan_(plan), original_(scene), scene_(std::move(scene)), state_(InitialState(*scene_)) {
  options_.libraries.Add(kCountingController);
  AddReplicas();
}

void ReferenceRun::AddReplicas() {
  const WorldDescription& world = scene_->world();
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const std::string& name = world.robots[i].name;
    if (!IsThere(world, RobotId(i)) || replicas_.contains(name)) continue;
    Result<std::unique_ptr<Replica>> replica = Replica::Create(world, {name}, options_);
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
  if (tick.edit->request.command == ControlCommand::kLoadWorld) original_ = result.scene;
  const bool new_world = result.scene != scene_;
  scene_ = result.scene;
  state_ = std::move(result.state);
  for (auto entry = replicas_.begin(); entry != replicas_.end();) {
    Replica& replica = *entry->second;
    Status status;
    if (new_world) {
      status = replica.ChangeWorld(scene_->world(), result.fresh, tick.frame.edition);
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

}  // namespace troupe::faults
