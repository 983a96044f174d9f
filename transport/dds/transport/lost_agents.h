// LostAgents: the agents whose proposals are still accepted after their lease has expired, because the run asks them to
// join again. Of too many the oldest is forgotten.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "transport/dds/binding/guid_prefix.h"
#include "transport/protocol/messages.h"

namespace troupe::dds {

class LostAgents {
 public:
  static constexpr std::size_t kMost = 1024;

  // Returns the agent that is forgotten for it, if any.
  std::optional<AgentId> Add(AgentId agent, const GuidPrefix& participant) {
    std::optional<AgentId> forgotten;
    if (agents_.size() == kMost && !agents_.contains(agent)) {
      const auto oldest = std::min_element(agents_.begin(), agents_.end(), [](const auto& a, const auto& b) {
        return a.second.number < b.second.number;
      });
      forgotten = oldest->first;
      agents_.erase(oldest);
    }
    agents_[agent] = {participant, next_number_++};
    return forgotten;
  }
  void Remove(AgentId agent) { agents_.erase(agent); }
  // Whether it was lost, and was of this participant.
  bool Contains(AgentId agent, const GuidPrefix& participant) const {
    const auto lost = agents_.find(agent);
    return lost != agents_.end() && lost->second.participant == participant;
  }

 private:
  struct Lost {
    GuidPrefix participant;
    std::uint64_t number = 0;  // in the order of the losses
  };

  std::map<AgentId, Lost> agents_;
  std::uint64_t next_number_ = 0;
};

}  // namespace troupe::dds
