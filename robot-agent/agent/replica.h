// Replica: an agent's copy of the world, with the robots that it runs in it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/protocol/messages.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "common/trace/tick_trace.h"
#include "robot-agent/agent/crew.h"
#include "robot-agent/agent/gateway.h"
#include "robot-agent/agent/robot.h"
#include "robot-agent/agent/scan_log.h"

namespace troupe {

class Replica {
 public:
  // REQUIRES: Validate(world) found nothing. `robots`: names; empty: every robot. `scan_log` may be null, and
  // `make_gateway` empty. `threads` share the robots, at most one for each 16; with a scan log, one. `trace` may be
  // null. The error is a robot that is unknown or named twice, or a controller that cannot be made. Throws what
  // `make_gateway` throws.
  static Result<std::unique_ptr<Replica>> Create(WorldDescription world, const std::vector<std::string>& robots,
                                                 ScanLog* scan_log, std::size_t threads = 1,
                                                 const MakeGateway& make_gateway = {}, TickTrace* trace = nullptr);

  // An edit has changed the world, or made the robots begin anew, or both. In a world of the same ids the robots go on,
  // but for those that were removed; if `fresh`, those whose names are in the world are made anew. `edition`: the
  // newest that is fresh, for the scan log. The error is a controller that cannot be made. Throws what `make_gateway`
  // throws.
  Status ChangeWorld(WorldDescription world, bool fresh, Edition edition);
  // The same in the world that it has.
  Status Renew(Edition edition);

  bool has_robots() const { return !robots_.empty(); }
  // Names of the agent's own robots, in the order of their ids.
  std::vector<std::string> RobotNames() const;

  // "" if the state belongs to the world (common/model/check_state.h); else what is wrong with it.
  std::string CheckState(const WorldState& state) const;

  // Takes in where an edit has put the robots. REQUIRES: CheckState(state) is "".
  void Carry(const WorldState& state);

  // What the agent's robots ask for after `state`: proposals in robot-id order, and controllers that failed just now.
  // REQUIRES: CheckState(state) is "".
  void Answer(const WorldState& state, ProposalMessage& answer);

  // Answers a paused `state`: nothing is decided. The same state may come to Answer later.
  // REQUIRES: CheckState(state) is "".
  void Hold(const WorldState& state, ProposalMessage& answer);

  // Of the thread that calls Answer; null without a trace.
  TraceLane* lane() const { return lanes_.front(); }

  // Shows the gateway the state of the last Answer or Hold.
  // REQUIRES: `state` is that state.
  void Publish(const WorldState& state);

 private:
  Replica(WorldDescription world, ScanLog* scan_log, const MakeGateway& make_gateway);
  Status MakeRobots(const std::vector<RobotId>& ids);
  std::vector<RobotId> Ids() const;
  void MakeNewGateway();
  // The gateway may go on in the world that there is now, with robots that begin anew if `fresh`.
  bool GatewayMayStay(bool fresh) const;
  void ResetIndices(std::size_t threads);
  void NameRobotsInTrace();

  // Robots and the gateway keep the scenes that they were made for.
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const Scene> robots_scene_;
  std::shared_ptr<const Scene> gateway_scene_;
  ScanLog* scan_log_;
  TickTrace* trace_ = nullptr;  // may be null
  MakeGateway make_gateway_;
  std::vector<std::unique_ptr<Robot>> robots_;  // by id
  std::vector<BodyIndex> indices_;              // one for each thread
  std::optional<Crew> crew_;                    // of several threads
  std::vector<TraceLane*> lanes_;               // one for each thread; null: no trace
  std::unique_ptr<Gateway> gateway_;            // may be null
};

}  // namespace troupe
