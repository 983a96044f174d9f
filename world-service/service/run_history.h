// RunHistory: the states of a run so far, for agents whose robots need the memory of them.
#pragma once

#include <optional>
#include <vector>

#include "common/base/result.h"
#include "common/protocol/messages.h"

namespace troupe {

// A request for states of the past.
struct HistoryRequest {
  std::optional<MemoryPlace> after = {};  // those that follow this one
  Edition from = 0;                       // without `after`: those from the first of this edition on
  bool operator==(const HistoryRequest&) const = default;
};

class RunHistory {
 public:
  virtual ~RunHistory() = default;
  // Some of the states, in order and without a gap, and without the newest of the run: another one follows each. Their
  // frames have no run. At least one, or an error. May be slow. Called on one thread at a time.
  virtual Result<std::vector<HistoryEntry>> Read(const HistoryRequest& request) = 0;
};

}  // namespace troupe
