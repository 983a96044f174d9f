#include "tests/faults/fault_plan.h"

#include <algorithm>

#include "tests/faults/network.h"

namespace troupe::faults {
namespace {

// Values for the parameters of any request.
struct RandomParameters {
  explicit RandomParameters(RandomSource& random) {
    static const std::string kNames[] = {"r0", "r1", "r2", "box", "scout", "crate", "nothing"};
    static constexpr std::uint8_t kScopes[] = {
        kResetAll, kResetAll, kResetTime, kResetState, kResetState | kResetTime, kResetSpawned};
    ticks = random.Index(6);
    name = kNames[random.Index(std::size(kNames))];
    scopes = kScopes[random.Index(std::size(kScopes))];
    pose = {random.Uniform(-4.0, 4.0), random.Uniform(-4.0, 4.0), 0.0, random.Uniform(-3.0, 3.0)};
    rename = random.Chance(0.5);
  }
  control::Request Spawn(RandomSource& random) const {
    const std::string source = random.Chance(0.6) ? "scout" : "crate";
    return control::Spawn{.source = source, .name = random.Chance(0.5) ? "" : source, .pose = pose, .rename = rename};
  }

  std::uint64_t ticks = 0;
  std::string name;
  std::uint8_t scopes = kResetAll;
  Pose pose;
  bool rename = false;
};

control::Request RandomRequest(RandomSource& random) {
  const std::size_t kind = random.Index(13);
  const RandomParameters values(random);
  switch (kind) {
    case 0:
      return control::Pause();
    case 1:
    case 2:
      return control::Play();
    case 3:
      return control::Step{values.ticks};
    case 4:
      return control::Reset{values.scopes};
    case 5:
      return control::LoadWorld();
    case 6:
    case 7:
      return values.Spawn(random);
    case 8:
      return control::Delete{values.name};
    case 9:
    case 10:
      return control::SetPose{values.name, values.pose};
    case 11:
      return control::Entities();
    default:
      return control::GetStatus();
  }
}

control::Request RandomEdit(RandomSource& random) {
  const std::size_t kind = random.Index(7);
  const RandomParameters values(random);
  switch (kind) {
    case 0:
    case 1:
      return control::Reset{values.scopes};
    case 2:
      return control::LoadWorld();
    case 3:
      return control::Spawn{.source = "scout", .name = values.name, .pose = values.pose, .rename = values.rename};
    case 4:
      return control::Delete{values.name};
    case 5:
      return control::SetPose{values.name, values.pose};
    default:
      return control::Restore{"r1", values.name, values.pose};
  }
}

MessageFaults RandomMessageFaults(RandomSource& random) {
  MessageFaults faults;
  faults.least_delay = random.Uniform(0.0002, 0.003);
  faults.most_delay = faults.least_delay + (random.Chance(0.3) ? random.Uniform(0.0, 0.1) : 0.001);
  if (random.Chance(0.7)) faults.loss = random.Uniform(0.0, 0.4);
  if (random.Chance(0.6)) faults.duplicate = random.Uniform(0.0, 0.4);
  if (random.Chance(0.6)) faults.reorder = random.Uniform(0.0, 0.4);
  return faults;
}

ProcessFault RandomFault(RandomSource& random, const FaultPlan& plan) {
  ProcessFault fault;
  static constexpr FaultKind kKinds[] = {FaultKind::kStop,      FaultKind::kStop,        FaultKind::kKill,
                                         FaultKind::kPartition, FaultKind::kPartitionTo, FaultKind::kPartitionFrom};
  fault.kind = kKinds[random.Index(std::size(kKinds))];
  if ((plan.memory || plan.gentle) && fault.kind == FaultKind::kKill) fault.kind = FaultKind::kStop;
  fault.at = random.Uniform(0.0, plan.faults_end);
  const double longest = plan.gentle ? 0.15 * plan.lease : 3.0 * plan.lease;
  fault.seconds = std::min(random.Uniform(0.0, longest), plan.faults_end - fault.at);
  fault.all_agents = random.Chance(0.15);
  const bool may_be_service = fault.kind == FaultKind::kStop;
  fault.victim = may_be_service && random.Chance(0.3) ? 0 : 1 + random.Index(8);
  return fault;
}

PlannedObserver RandomObserver(RandomSource& random, const FaultPlan& plan) {
  PlannedObserver observer;
  observer.joins_at = random.Uniform(0.0, plan.faults_end);
  if (random.Chance(0.4)) {
    observer.stops_at = random.Uniform(observer.joins_at, plan.faults_end);
    observer.stopped_seconds = std::min(random.Uniform(0.0, 3.0 * plan.lease), plan.faults_end - observer.stops_at);
  }
  if (random.Chance(0.3)) observer.dies_at = random.Uniform(observer.joins_at, plan.faults_end);
  return observer;
}

}  // namespace

// An agent dies in a quiescent pause, and an edit follows before its lease has expired.
void AddDeathBeforeAnEdit(RandomSource& random, FaultPlan& plan) {
  const double at = random.Uniform(1.0, 2.0);
  const control::Request edit = RandomEdit(random);
  const double death = at + 0.6;
  plan.requests.push_back({at, control::Pause()});
  plan.requests.push_back({death + random.Uniform(0.0, plan.lease), edit});
  plan.requests.push_back({death + 2.5 * plan.lease, control::Play()});
  plan.faults.push_back({FaultKind::kKill, death, 0.0, 1 + random.Index(8), random.Chance(0.15)});
  if (random.Chance(0.3)) plan.faults.push_back({FaultKind::kKill, death + random.Uniform(0.0, 1.0), 0.0, 1, false});
  plan.restarts = std::max(plan.restarts, 2U);
  plan.faults_end = std::max(plan.faults_end, death + 3.0 * plan.lease);
}

FaultPlan MakePlan(std::uint64_t seed) {
  RandomSource random(seed, 1);
  FaultPlan plan;
  plan.seed = seed;
  plan.robots = 1 + random.Index(4);
  plan.packing = 1 + random.Index(2);
  plan.lease = random.Uniform(0.3, 1.0);
  plan.faults_end = random.Uniform(1.5, 5.0);
  plan.gentle = random.Chance(0.3);
  plan.memory = random.Chance(0.4);
  plan.settings.speed = random.Uniform(0.5, 1.5);  // a tick is 0.1 s long
  const bool pause = plan.memory && !plan.gentle;
  plan.settings.on_agent_loss = pause || random.Chance(0.5) ? OnAgentLoss::kPause : OnAgentLoss::kFreeze;
  static constexpr double kDeadlines[] = {10.0, 10.0, 3.0, 0.0};
  plan.settings.agent_deadline_seconds = kDeadlines[random.Index(std::size(kDeadlines))];
  if (random.Chance(0.25)) plan.settings.ticks = 5 + random.Index(60);
  plan.start_paused = random.Chance(0.1);
  plan.restarts = static_cast<std::uint32_t>(random.Index(4));
  plan.messages = RandomMessageFaults(random);
  const std::size_t faults = random.Index(6);
  for (std::size_t i = 0; i < faults; ++i) plan.faults.push_back(RandomFault(random, plan));
  const std::size_t requests = random.Chance(0.7) ? random.Index(10) : 0;
  for (std::size_t i = 0; i < requests; ++i) {
    plan.requests.push_back({random.Uniform(0.0, plan.faults_end), RandomRequest(random)});
  }
  if (!plan.gentle && random.Chance(0.05)) {
    plan.service_dies = true;
    plan.faults.push_back({FaultKind::kKill, random.Uniform(0.0, plan.faults_end), 0.0, 0, false});
  }
  if (!plan.service_dies && random.Chance(0.4)) {
    plan.service_returns = true;
    const std::size_t deaths = 1 + random.Index(3);
    for (std::size_t i = 0; i < deaths; ++i) {
      const FaultKind kind = random.Chance(0.5) ? FaultKind::kKill : FaultKind::kKillInCommit;
      plan.faults.push_back({kind, random.Uniform(0.0, plan.faults_end), 0.0, 0, false});
    }
  }
  if (!plan.memory && !plan.gentle && random.Chance(0.3)) AddDeathBeforeAnEdit(random, plan);
  plan.only_deaths = std::all_of(plan.faults.begin(), plan.faults.end(), [](const ProcessFault& fault) {
    return fault.kind == FaultKind::kKill || fault.kind == FaultKind::kKillInCommit;
  });
  const std::size_t observers = random.Index(3);
  for (std::size_t i = 0; i < observers; ++i) plan.observers.push_back(RandomObserver(random, plan));
  return plan;
}

}  // namespace troupe::faults
