// RunProgress: the state of a run beside its world, as its journal has it: a service that continues the run needs it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "transport/protocol/messages.h"
#include "troupe/ids.h"

namespace troupe {

struct RunProgress {
  Incarnation incarnation = 0;                  // of the service that wrote it
  std::optional<std::uint64_t> ticks_to_pause;  // 0 in a pause; nothing: the run plays
  std::vector<RobotId> absent;                  // robots whose agents are lost, ascending
  std::vector<RobotId> newcomers;               // robots of the newest edit that have no agent yet
  std::uint64_t stalls = 0;                     // so far, for the summary
  std::uint64_t rejected = 0;
  bool operator==(const RunProgress&) const = default;
};

}  // namespace troupe
