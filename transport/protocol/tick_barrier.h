// TickBarrier: collects one proposal message from each member for the next tick, and knows the missing members. The
// heart of lockstep: the service steps when it is complete.
//
// It knows names only: the proposals themselves are kept by the tick engine. An answer costs the logarithm of the
// number of members; opening a tick costs nothing for each member. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "transport/protocol/messages.h"

namespace troupe {

class TickBarrier {
 public:
  // Adding a member, or removing an agent that is none, changes nothing. The open tick waits for a new member, too.
  void AddMember(AgentId agent);
  void RemoveMember(AgentId agent);

  // Drops all answers and waits for the answers to `tick`.
  void Open(Tick tick);
  Tick tick() const { return tick_; }

  // True if this was the first answer of a member for the open tick; others change nothing.
  bool Arrive(AgentId agent);

  bool complete() const { return missing_ == 0; }
  std::size_t members() const { return last_round_.size(); }
  std::size_t missing() const { return missing_; }
  // The members that have not answered, in id order.
  std::vector<AgentId> Missing() const;

 private:
  // Every Open begins a new round, so that opening costs nothing for each member.
  std::map<AgentId, std::uint64_t> last_round_;  // in which the member answered; 0: in none
  std::uint64_t round_ = 1;
  std::size_t missing_ = 0;
  Tick tick_ = 0;
};

}  // namespace troupe
