// ProposalCollector: the proposals that enter the next step, all of them valid.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "transport/protocol/messages.h"
#include "world-service/service/membership.h"
#include "worldfile/load_world.h"

namespace troupe {

struct Rejection {
  std::optional<RobotId> robot;
  std::string reason;
};

class ProposalCollector {
 public:
  // REQUIRES: the world outlives the collector, or the next ChangeWorld.
  ProposalCollector(const WorldDescription& world, Mode mode);

  // An edit has changed the world or its state: all proposals are dropped.
  void ChangeWorld(const WorldDescription& world);

  // Collects the valid proposals of a member's first message for `message.tick`; returns the others. The result is
  // valid until the next call. REQUIRES: robots' states in `state` are those that the tick starts from.
  std::span<const Rejection> Collect(const Member& member, const ProposalMessage& message, const WorldState& state);

  // The proposals for the step from `state` to the next tick, in robot-id order; valid until the next call. In realtime
  // mode, a robot without a proposal for that tick keeps the one for the tick before.
  std::span<const Proposal> ForStep(const WorldState& state);

 private:
  struct Newest {
    Proposal proposal;
    Tick tick = 0;  // that it is for; 0: none yet
  };

  const WorldDescription* world_;
  const Mode mode_;
  std::vector<Newest> newest_;  // by robot
  // Members for their memory only.
  std::vector<Proposal> for_step_;
  std::vector<Rejection> rejections_;
};

}  // namespace troupe
