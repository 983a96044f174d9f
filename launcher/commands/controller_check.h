// ControllerCheck: runs the controllers of a recorded run again, on the recorded states, and compares their proposals
// with the recorded ones. docs/recording.md says which robots are compared.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/base/thread_pool.h"
#include "robot-agent/agent/replica.h"
#include "troupe/result.h"
#include "world-service/replay/replayed_world.h"

namespace troupe {

class ControllerCheck {
 public:
  // The error is a run in which proposals do not follow from the states: mode realtime.
  static Result<ControllerCheck> Create(const Recording& recording);

  // Lets the robots decide on the state of `world`, and compares with `next`, which follows it. Call it with each state
  // from the begin of the run. Returns the first difference. The error is a controller that cannot be made.
  Result<std::optional<std::string>> Check(const ReplayedWorld& world, const RecordedTick& next);

  std::uint64_t compared() const { return compared_; }  // proposals
  // Robots whose agents were lost: their controllers are not compared from then on. By name.
  const std::set<std::string>& lost() const { return lost_; }

 private:
  explicit ControllerCheck(const Recording& recording) : settings_(recording.run().settings) {}

  // Changes the replicas as the agents of the run did.
  Status Follow(const ReplayedWorld& world);
  Status AddReplica(const ReplayedWorld& world, const std::vector<std::string>& robots);
  void NoteLosses(const WorldDescription& world, const RecordedTick& next);
  std::optional<std::string> Compare(const ReplayedWorld& world, const RecordedTick& next);

  const RunSettings& settings_;
  // A robot that an edit adds has an agent of its own.
  std::vector<std::unique_ptr<Replica>> replicas_;
  const std::shared_ptr<ThreadPool> pool_ = std::make_shared<ThreadPool>(std::thread::hardware_concurrency());
  std::shared_ptr<const Scene> scene_;  // of the replicas
  Edition edition_ = 0;                 // of the state
  Edition followed_edition_ = 0;        // by the replicas
  Edition fresh_edition_ = 0;
  std::set<std::string> absent_;   // robots without an agent
  std::set<std::string> unknown_;  // robots whose agents were lost since they were made
  std::set<std::string> lost_;
  std::uint64_t compared_ = 0;
};

}  // namespace troupe
