#include "common/traffic/traffic_routes.h"

#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace troupe {

void TrafficRoutes::Begin(const std::vector<bool>& closed) {
  if (closed == closed_ && kept_.size() * graph_->vertices() < kMaxKept) return;
  closed_ = closed;
  kept_.clear();
}

const std::vector<float>& TrafficRoutes::To(std::uint32_t goal) {
  const auto [kept, is_new] = kept_.try_emplace(goal);
  std::vector<float>& seconds = kept->second;
  if (!is_new) return seconds;
  seconds.assign(graph_->vertices(), std::numeric_limits<float>::infinity());
  using Entry = std::pair<float, std::uint32_t>;  // s, vertex
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  seconds[goal] = 0.0F;
  open.push({0.0F, goal});
  while (!open.empty()) {
    const auto [at, vertex] = open.top();
    open.pop();
    if (at > seconds[vertex]) continue;
    for (const TrafficExit& entry : graph_->entries(vertex)) {
      const float by_this = at + static_cast<float>(entry.seconds);
      if (closed_[entry.lane] || by_this >= seconds[entry.to]) continue;
      seconds[entry.to] = by_this;
      open.push({by_this, entry.to});
    }
  }
  return seconds;
}

}  // namespace troupe
