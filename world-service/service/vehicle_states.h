// VehicleStates: the newest state that each vehicle of VDA 5050 has sent to its fleet control, for tools that ask. By
// the names of robots, because edits change ids.
#pragma once

#include <map>
#include <span>
#include <string>

#include "common/model/proposal.h"
#include "troupe/world_description.h"

namespace troupe {

class VehicleStates {
 public:
  // Of a tick in that world.
  void Add(const WorldDescription& world, std::span<const Proposal> proposals) {
    for (const Proposal& proposal : proposals) {
      for (const FleetMessage& message : proposal.fleet) {
        if (message.topic == FleetTopic::kState) texts_[world.robot(proposal.robot).name] = message.text;
      }
    }
  }
  // Controllers begin anew, or go on from an earlier tick.
  void Clear() { texts_.clear(); }
  // JSON; null: none is known.
  const std::string* Of(const std::string& robot) const {
    const auto found = texts_.find(robot);
    return found != texts_.end() ? &found->second : nullptr;
  }

 private:
  std::map<std::string, std::string> texts_;
};

}  // namespace troupe
