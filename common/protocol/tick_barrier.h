// TickBarrier: collects one proposal message from each member for the next tick, and knows who is missing.
#pragma once

#include <map>
#include <vector>

#include "common/protocol/messages.h"

namespace troupe {

class TickBarrier {
 public:
  void AddMember(AgentId agent);
  void RemoveMember(AgentId agent);

  // Forgets all proposals and waits for those of `tick`.
  void Open(Tick tick);
  Tick tick() const { return tick_; }

  // True if this was the first answer of a member for the open tick; others change nothing.
  bool Arrive(AgentId agent);

  bool complete() const { return missing_ == 0; }
  // The members that have not answered, in id order.
  std::vector<AgentId> Missing() const;

 private:
  std::map<AgentId, bool> arrived_;
  std::size_t missing_ = 0;
  Tick tick_ = 0;
};

}  // namespace troupe
