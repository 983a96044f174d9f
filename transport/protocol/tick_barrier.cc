#include "transport/protocol/tick_barrier.h"

namespace troupe {

void TickBarrier::AddMember(AgentId agent) {
  if (last_round_.emplace(agent, 0).second) ++missing_;
}

void TickBarrier::RemoveMember(AgentId agent) {
  const auto member = last_round_.find(agent);
  if (member == last_round_.end()) return;
  if (member->second != round_) --missing_;
  last_round_.erase(member);
}

void TickBarrier::Open(Tick tick) {
  tick_ = tick;
  ++round_;
  missing_ = last_round_.size();
}

bool TickBarrier::Arrive(AgentId agent) {
  const auto member = last_round_.find(agent);
  if (member == last_round_.end() || member->second == round_) return false;
  member->second = round_;
  --missing_;
  return true;
}

std::vector<AgentId> TickBarrier::Missing() const {
  std::vector<AgentId> missing;
  missing.reserve(missing_);
  for (const auto& [agent, round] : last_round_) {
    if (round != round_) missing.push_back(agent);
  }
  return missing;
}

}  // namespace troupe
