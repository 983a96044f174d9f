// ProposalCollector: the proposals that enter the next step. It lets nothing in that a step must not see.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/protocol/messages.h"
#include "common/worldfile/load_world.h"
#include "world-service/service/membership.h"

namespace troupe {

struct Rejection {
  std::optional<RobotId> robot;
  std::string reason;
};

class ProposalCollector {
 public:
  // The world must stay until it is changed for another one.
  ProposalCollector(const WorldDescription& world, Mode mode);

  // An edit has changed the world: no proposal is left over.
  void ChangeWorld(const WorldDescription& world);

  // Takes what is good in a member's first message for `message.tick`; returns what is not, until the next call.
  // REQUIRES: robots' states in `state` are those that the tick starts from.
  std::span<const Rejection> Take(const Member& member, const ProposalMessage& message, const WorldState& state);

  // What goes into the step from `state` to the next tick, in robot-id order, until the next call. In realtime mode, a
  // robot without a proposal for that tick keeps the one for the tick before.
  std::span<const Proposal> ForStep(const WorldState& state);

 private:
  struct Newest {
    Proposal proposal;
    Tick tick = 0;  // that it is for; 0: none yet
  };

  const WorldDescription* world_;
  const Mode mode_;
  std::vector<Newest> newest_;  // by robot
  // Kept for their memory.
  std::vector<Proposal> for_step_;
  std::vector<Rejection> rejections_;
};

}  // namespace troupe
