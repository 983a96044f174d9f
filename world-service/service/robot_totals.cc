#include "world-service/service/robot_totals.h"

#include <algorithm>
#include <utility>

#include "common/model/zones.h"
#include "common/signals/state_tables.h"

namespace troupe {
namespace {

ModelId RootOf(const WorldDescription& world, ModelId model) {
  while (const std::optional<ModelId>& parent = world.model(model).parent) model = *parent;
  return model;
}

}  // namespace

Status RobotTotals::OnBegin(const RunStart& start) {
  scene_ = start.scene;
  return {};
}

void RobotTotals::OnWorldChange(const std::shared_ptr<const Scene>& scene, Edition) {
  scene_ = scene;
}

Status RobotTotals::OnTick(const CommittedTick& tick) {
  const WorldState& state = tick.frame.state;
  const bool begins = tick.edit != nullptr && tick.frame.fresh_edition == tick.frame.edition;
  if (begins || !since_) {
    robots_.clear();
    traffic_.Clear();
    since_ = state.tick;
  }
  const std::size_t known = std::min(robots_.size(), state.robots.size());
  robots_.resize(state.robots.size());
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const Vec2 position = state.robots[i].X_WR.translation();
    if (tick.edit == nullptr && i < known) robots_[i].distance += (position - robots_[i].position).norm();
    robots_[i].position = position;
  }
  if (tick.edit == nullptr) {
    for (const Event& event : tick.frame.events) Count(event);
    for (const RobotCommand& command : tick.commands) Count(command);
  }
  tick_ = state.tick;
  stores_ = state.stores;
  flows_ = state.flows;
  zones_ = state.zones;
  waiting_.assign(flows_.size(), 0);
  for (const Job& job : state.jobs) waiting_[job.flow] += job.is_loaded ? 0 : 1;
  traffic_.Add(scene_->world(), state);
  return {};
}

std::vector<PlaceWaits> RobotTotals::FindWaits(std::size_t most_of_kind) const {
  return scene_ == nullptr ? std::vector<PlaceWaits>() : traffic_.FindWaits(scene_->world(), most_of_kind);
}

void RobotTotals::Count(const Event& event) {
  if (!event.robot || event.robot->index() >= robots_.size()) return;
  Counts& counts = robots_[event.robot->index()];
  if (event.type == EventType::kStallBegan) {
    ++counts.stalls;
    // By the root: a user knows the table, not its leg.
    if (event.other) ++counts.contacts[RootOf(scene_->world(), *event.other)];
  } else if (event.type == EventType::kGripped) {
    ++counts.grips;
  }
}

void RobotTotals::Count(const RobotCommand& command) {
  if (!command.goal || command.goal->waypoints.empty() || command.robot.index() >= robots_.size()) return;
  Counts& counts = robots_[command.robot.index()];
  // A goal is sent with every frame while it is in force; its number tells a new one.
  if (std::exchange(counts.goal, command.goal->number) != command.goal->number || counts.goals == 0) {
    ++counts.goals;
    counts.is_reached = false;
  }
  if (counts.is_reached || (command.goal->waypoints.back() - counts.position).norm() > kGoalReached) return;
  counts.is_reached = true;
  ++counts.goals_reached;
}

std::vector<FlowTotal> RobotTotals::CollectFlows() const {
  std::vector<FlowTotal> totals;
  if (scene_ == nullptr) return totals;
  const WorldDescription& world = scene_->world();
  const double hours = static_cast<double>(tick_) * world.interval_seconds() / 3600.0;
  for (std::size_t i = 0; i < std::min(flows_.size(), world.flows.size()); ++i) {
    const FlowState& counts = flows_[i];
    FlowTotal& total = totals.emplace_back();
    total.flow = world.flows[i].name;
    total.arrived = counts.arrived;
    total.refused = counts.refused;
    total.delivered = counts.delivered;
    total.late = counts.late;
    if (counts.late > 0) {
      total.lateness =
          static_cast<double>(counts.lateness) * world.interval_seconds() / static_cast<double>(counts.late);
    }
    if (hours > 0.0) total.per_hour = static_cast<double>(counts.delivered) / hours;
    total.waiting = waiting_[i];
  }
  return totals;
}

std::vector<CleaningTotal> RobotTotals::CollectCleaning() const {
  std::vector<CleaningTotal> totals;
  if (scene_ == nullptr) return totals;
  const WorldDescription& world = scene_->world();
  for (std::size_t i = 0; i < std::min(zones_.size(), world.zones.size()); ++i) {
    if (world.zones[i].kind != ZoneKind::kCleaning) continue;
    const std::size_t cells = CountCells(world.zones[i]);
    totals.push_back(
        {world.zones[i].name, cells > 0 ? static_cast<double>(zones_[i].covered) / static_cast<double>(cells) : 0.0});
  }
  return totals;
}

std::vector<RobotTotal> RobotTotals::Collect(std::size_t most) const {
  std::vector<RobotTotal> totals;
  if (scene_ == nullptr) return totals;
  const WorldDescription& world = scene_->world();
  const Things things(world);
  for (std::size_t i = 0; i < std::min(robots_.size(), world.robots.size()) && totals.size() < most; ++i) {
    if (!RobotExists(world, RobotId(i))) continue;
    const Counts& counts = robots_[i];
    RobotTotal& total = totals.emplace_back();
    total.robot = world.robots[i].name;
    total.distance = counts.distance;
    total.stalls = counts.stalls;
    total.grips = counts.grips;
    total.goals = counts.goals;
    total.goals_reached = counts.goals_reached;
    std::vector<std::pair<ModelId, std::uint64_t>> contacts(counts.contacts.begin(), counts.contacts.end());
    std::stable_sort(contacts.begin(), contacts.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    contacts.resize(std::min(contacts.size(), kMaxContacts));
    for (const auto& [obstacle, count] : contacts) total.contacts.push_back(world.model(obstacle).name);
    for (const std::size_t store : things.stores_of(RobotId(i))) {
      if (store >= stores_.size()) continue;
      const ModelId model = things.model(things.first(KindOf("stores")) + static_cast<ThingId>(store)).value();
      total.joules = total.joules.value_or(0.0) + stores_[store].joules;
      total.capacity = total.capacity.value_or(0.0) + world.model(model).power.capacity;
    }
  }
  return totals;
}

}  // namespace troupe
