#include "viewer/gateway/viewer.h"

#include <algorithm>
#include <utility>

#include "viewer/gateway/page_texts.h"

namespace troupe {

// The rows are compared once for all viewers.
void ShownRun::Follow(const RunFeed& feed) {
  const SharedState before = content.state;
  const std::optional<StatusMessage> status_before = content.status;
  const std::uint64_t version = content.version;
  feed.Read(content);
  if (content.version != version) ++update;
  const SharedState& state = content.state;
  if (state != before && state != nullptr) {
    rows.Assign(state->state, update, before == nullptr || before->world != state->world);
  }
  if (content.status != status_before) status = StatusText(content.status);
}

void ShownRun::Describe(std::vector<TimeSpan> newest) {
  // The newest span grows, and the oldest shrinks, with the ends in each update.
  const bool is_same =
      newest.size() == spans.size() &&
      std::equal(newest.begin(), newest.end(), spans.begin(), [&](const TimeSpan& a, const TimeSpan& b) {
        return a.first - a.tick == b.first - b.tick && (&a == &newest.back() || a.last == b.last) &&
               (&a == &newest.front() || a.first == b.first);
      });
  if (is_same) return;
  timeline = TimelineText(newest);
  spans = std::move(newest);
}

}  // namespace troupe
