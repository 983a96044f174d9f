#include "world-service/service/event_log.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace troupe {
namespace {

constexpr int kReportedPerSecond = 10;

}  // namespace

void EventLog::Add(EventType type, Tick tick, std::optional<RobotId> robot, std::string detail) {
  unreported_.push_back({tick, type, robot, std::nullopt, std::move(detail)});
  between_frames_.push_back(unreported_.back());
}

bool EventLog::Reject(Tick tick, std::optional<RobotId> robot, std::string reason, double now) {
  ++rejected_;
  if (now - second_began_ >= 1.0) {
    second_began_ = now;
    rejected_this_second_ = 0;
    if (const std::uint64_t count = std::exchange(silent_, 0); count > 0) {
      Add(EventType::kProposalRejected, tick, std::nullopt, std::to_string(count) + " more, not shown");
    }
  }
  if (++rejected_this_second_ > kReportedPerSecond) {
    ++silent_;
    return false;
  }
  Add(EventType::kProposalRejected, tick, robot, std::move(reason));
  return true;
}

std::vector<Event> EventLog::CompleteFrame(Tick tick, std::vector<Event> of_step) {
  for (const Event& event : of_step) stalls_ += event.type == EventType::kStallBegan;
  unreported_.insert(unreported_.end(), of_step.begin(), of_step.end());
  if (between_frames_.empty()) return of_step;
  // They arrived in the order of the network; ordered by robot, records of two runs are easier to compare.
  std::stable_sort(between_frames_.begin(), between_frames_.end(),
                   [](const Event& a, const Event& b) { return a.robot < b.robot; });
  for (Event& event : between_frames_) event.tick = tick;
  between_frames_.insert(between_frames_.end(), std::make_move_iterator(of_step.begin()),
                         std::make_move_iterator(of_step.end()));
  return std::exchange(between_frames_, {});
}

std::vector<Event> EventLog::DrainUnreported() {
  return std::exchange(unreported_, {});
}

}  // namespace troupe
