// Replica: an agent's copy of the world, with the robots that the agent simulates. It has no state of its own: each
// frame brings the whole state, and the replica keeps the scene (constant), indices of bodies (caches) and the robots
// with their memory.
//
// Measuring, deciding and the drive are here; the step is not: only the service moves robots. A robot reads the whole
// state, and writes its proposal alone, so that threads divide robots freely, with the same answer whatever the
// division. Reports are sorted by robot afterwards.
//
// Robots and gateways hold pointers into the scene that they were made for, so that the replica keeps earlier scenes as
// long as one of them may be in use.
//
// Threads: one at a time; Decide divides the robots among threads of its own.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/thread_pool.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "common/trace/tick_trace.h"
#include "robot-agent/agent/gateway.h"
#include "robot-agent/robot/robot.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe {

class Replica {
 public:
  // `robots`: names; empty: every robot. `options`: of each robot. Threads of the pool divide
  // the robots, one for each 16; without a pool (null) and with a scan log, one does all. `make_gateway` may be empty,
  // and `trace` null. The error is a robot that is unknown or named twice, or a controller or a gateway that cannot be
  // made.
  static Result<std::unique_ptr<Replica>> Create(std::shared_ptr<const Scene> scene,
                                                 const std::vector<std::string>& robots,
                                                 const RobotOptions& options = {},
                                                 std::shared_ptr<ThreadPool> pool = {},
                                                 const MakeGateway& make_gateway = {}, TickTrace* trace = nullptr);

  // Applies an edit of the world. If `fresh`, the robots that the new world has by name start again; otherwise it keeps
  // the ids of the old world, and all robots continue but removed ones and robots with another controller. `edition`:
  // of the newest fresh start, for the scan log. The error is a controller or a gateway that cannot be made.
  Status ChangeWorld(std::shared_ptr<const Scene> scene, bool fresh, Edition edition);
  // Starts the robots again in the present world. The error is as above.
  Status Renew(Edition edition);

  // Makes the named robots that the world has and the replica lacks. The error is as above.
  Status AddRobots(const std::vector<std::string>& names);
  // Ends the named robots, as far as it has them. The error is a gateway that cannot be made.
  Status RemoveRobots(const std::set<std::string>& names);

  const std::shared_ptr<const Scene>& scene() const { return scene_; }
  bool has_robots() const { return !robots_.empty(); }
  // Names of the agent's own robots, in the order of their ids.
  std::vector<std::string> RobotNames() const;
  // The names of the robots whose controllers accept goals.
  std::vector<std::string> NamesThatAcceptGoals() const;

  // The error is that of troupe::CheckState: the state does not belong to the world.
  Status CheckState(const WorldState& state) const;

  // Applies the poses that an edit has given to the robots. REQUIRES: CheckState(state).ok()
  void Relocate(const WorldState& state);

  // Measures and decides for tick `state.tick` + 1: the proposals in robot-id order, and what controllers reported, or
  // that they failed, in this call. `commands`: from outside, for any robots of the world, in robot-id order; one that
  // the world refuses is reported. The caller sets run, agent and edition. REQUIRES: CheckState(state).ok()
  // `memory`: proposals that are replaced, whose memory is reused.
  ProposalMessage Decide(const WorldState& state, std::span<const RobotCommand> commands = {},
                         std::vector<Proposal> memory = {});

  // As Decide, for a state of the past, so that the robots remember it: without gateway and scan log.
  // REQUIRES: CheckState(state).ok()
  std::vector<Proposal> Retrace(const WorldState& state, std::span<const RobotCommand> commands = {});

  // The answer to a paused `state`: no decisions. Decide may follow for the same state.
  // REQUIRES: CheckState(state).ok()
  ProposalMessage Pause(const WorldState& state);

  // The lane of the thread that calls Decide; null without a trace.
  TraceLane* lane() const { return lanes_.front(); }

  // Publishes the state of the last Decide or Pause through the gateway. REQUIRES: `state` is that state.
  void Publish(const WorldState& state);
  // Waits until all messages of the gateway are on their way.
  void AwaitPublished();
  // Lets the gateway publish it again for new readers. REQUIRES: as above.
  void Repeat(const WorldState& state);
  bool has_gateway() const { return gateway_ != nullptr; }

 private:
  Replica(std::shared_ptr<const Scene> scene, const RobotOptions& options, const MakeGateway& make_gateway)
      : scene_(std::move(scene)), options_(options), make_gateway_(make_gateway) {}
  // Moves the robots to the scene; robots that have another controller there are made again.
  Status FollowWorld(const Scene& before);
  Status MakeRobots(const std::vector<RobotId>& ids);
  std::vector<RobotId> Ids() const;
  Status MakeNewGateway();
  // True if the gateway fits the present world, with robots that start again if `fresh`.
  bool GatewayFits(bool fresh) const;
  void ResetIndices(std::size_t threads);
  void NameRobotsInTrace();
  void AddCommands(std::span<const RobotCommand> commands, std::span<ExternalCommand> external,
                   std::vector<std::string>& reports) const;
  void Show(const WorldState& state, void (Gateway::*show)(Tick, std::span<const RobotView* const>));
  // Calls decide(robot, its index, bodies, lane) for each robot, divided among the threads.
  template <typename DecideOne>
  void DecideAll(const WorldState& state, const DecideOne& decide);

  // Robots and the gateway hold pointers into the scenes that they were made for.
  std::shared_ptr<const Scene> scene_;
  std::vector<std::shared_ptr<const Scene>> robots_scenes_;
  std::shared_ptr<const Scene> gateway_scene_;
  std::shared_ptr<const Scene> shown_scene_;  // of the gateway's last ChangeWorld
  RobotOptions options_;
  TickTrace* trace_ = nullptr;  // may be null
  MakeGateway make_gateway_;
  std::vector<std::unique_ptr<Robot>> robots_;  // by id
  std::vector<BodyIndex> indices_;              // one for each thread
  std::shared_ptr<ThreadPool> pool_;            // null: one thread
  std::vector<TraceLane*> lanes_;               // one for each thread; null: no trace
  std::unique_ptr<Gateway> gateway_;            // may be null
};

}  // namespace troupe
