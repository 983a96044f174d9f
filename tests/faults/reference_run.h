// ReferenceRun: the run without service, agents and faults: one replica for each robot, and the step. It follows the
// committed ticks of a simulated run, makes the same edits at the same ticks, and compares every proposal and every
// hash.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "robot-agent/agent/replica.h"
#include "tests/faults/fault_plan.h"
#include "troupe/world_description.h"
#include "world-service/service/run_observer.h"

namespace troupe::faults {

class ReferenceRun final : public RunObserver {
 public:
  ReferenceRun(std::shared_ptr<const Scene> scene, const FaultPlan& plan);

  Status OnTick(const CommittedTick& tick) override;

  // The first difference; empty: none.
  const std::string& difference() const { return difference_; }
  Tick ticks() const { return ticks_; }  // that were compared
  std::uint64_t hash() const { return hash_; }
  // The hash of a committed tick; nothing if it does not exist.
  std::optional<std::uint64_t> HashOf(Edition edition, Tick tick) const;
  Edition edition() const { return edition_; }
  Tick tick() const { return state_.tick; }

 private:
  void Edit(const CommittedTick& tick);
  void Advance(const CommittedTick& tick);
  // Makes replicas of robots that have none.
  void AddReplicas();
  void Differ(const CommittedTick& tick, const std::string& what);

  const FaultPlan& plan_;
  RobotOptions options_;
  std::shared_ptr<const Scene> original_;
  std::shared_ptr<const Scene> scene_;
  WorldState state_;
  std::uint64_t hash_ = 0;
  std::map<std::pair<Edition, Tick>, std::uint64_t> hashes_;
  Edition edition_ = 0;
  bool begun_ = false;
  std::map<std::string, std::unique_ptr<Replica>> replicas_;  // by the robot's name
  std::string difference_;
  Tick ticks_ = 0;
};

// The worlds of simulated runs: small, but with contacts, so that the order of the robots counts.

// The shared library of counting_controller.cc.
inline constexpr const char* kCountingController = TROUPE_COUNTING_CONTROLLER;

// `robots` robots "r0", "r1", ... that drive into each other and a box. `memory`: some have a controller that
// remembers.
WorldDescription RunWorld(std::size_t robots, bool memory);
// For `load`: other robots in another order.
std::shared_ptr<const WorldDescription> OtherWorld(bool memory);
// For `spawn` of "scout", a robot, or "crate", an object.
std::shared_ptr<const WorldDescription> WorldToSpawn(const std::string& source, bool memory);

}  // namespace troupe::faults
