#include "world-service/observers/ros/tick_answers.h"

#include <fmt/format.h>

#include <algorithm>

namespace troupe {
namespace {

constexpr double kFirstAnswers = 5.0;  // s, until a notice of participants that have never answered

}  // namespace

void TickAnswers::SetParticipants(const std::set<Name>& names) {
  std::erase_if(participants_, [&](const auto& entry) { return !names.contains(entry.first); });
  const bool were_heard = !std::exchange(has_participants_, true) && options_.were_heard;
  for (const Name& name : names) {
    participants_.try_emplace(name, Participant{were_heard ? Answer::kAwaited : Answer::kNeverHeard});
  }
}

void TickAnswers::Publish(Tick tick, double now) {
  for (auto& [name, participant] : participants_) {
    // One that follows the time has nothing to say to the same tick again.
    const bool stays = participant.follows_time && tick == tick_;
    if (participant.answer == Answer::kDone && !stays) participant.answer = Answer::kAwaited;
    participant.is_calling = false;
  }
  stage_ = Stage::kAwaitingAnswers;
  tick_ = tick;
  published_at_ = now;
  delivery_ = Delivery::kUnknown;
  absent_.clear();
  time_stands_ = !released_ || tick <= *released_;
}

bool TickAnswers::IsAwaited(const Participant& participant) const {
  if (participant.follows_time && time_stands_) return false;
  return participant.answer == Answer::kNeverHeard || participant.answer == Answer::kAwaited;
}

bool TickAnswers::is_awaited(const Name& name) const {
  const auto found = participants_.find(name);
  return found != participants_.end() && IsAwaited(found->second);
}

void TickAnswers::SetDelivery(Delivery delivery, const std::set<Name>& absent, double now) {
  if (delivery_ == Delivery::kHeld && delivery == Delivery::kTold) published_at_ = now;
  delivery_ = delivery;
  absent_ = absent;
}

void TickAnswers::SetCalling(const std::set<Name>& calling, double now) {
  for (auto& [name, participant] : participants_) {
    const bool is_calling = calling.contains(name);
    if (std::exchange(participant.is_calling, is_calling) && !is_calling) participant.called_until = now;
  }
}

bool TickAnswers::are_complete() const {
  return std::none_of(participants_.begin(), participants_.end(),
                      [this](const auto& entry) { return IsAwaited(entry.second); });
}

void TickAnswers::OnAnswer(const Name& name, double now) {
  OnOtherAnswer(name);
  const auto found = participants_.find(name);
  if (found == participants_.end() || stage_ != Stage::kAwaitingAnswers) return;
  Participant& participant = found->second;
  if (std::exchange(participant.answer, Answer::kDone) == Answer::kDone) return;
  participant.waited_seconds += now - published_at_;
  if (are_complete()) ++participant.times_last;
}

void TickAnswers::OnAnswerBeforeEdit(const Name& name, double now) {
  const auto found = participants_.find(name);
  if (found != participants_.end() && found->second.follows_time) OnAnswer(name, now);
}

void TickAnswers::OnOtherAnswer(const Name& name) {
  const auto found = participants_.find(name);
  if (found == participants_.end() || found->second.answer == Answer::kDone) return;
  if (std::exchange(found->second.answer, Answer::kAwaited) == Answer::kDropped) {
    report_(fmt::format("ticks wait for {} again", name.second));
  }
}

void TickAnswers::SetReadsClock(const Name& topic, bool reads_clock, double now) {
  const auto found = participants_.find(topic);
  if (found == participants_.end() || found->second.reads_clock_since.has_value() == reads_clock) return;
  found->second.reads_clock_since = reads_clock ? std::optional(now) : std::nullopt;
}

Result<std::vector<std::string>> TickAnswers::Awaited(double now) {
  std::vector<std::string> names;
  bool has_new = false;
  for (auto& [name, participant] : participants_) {
    const bool is_limited =
        options_.limit > 0.0 && !participant.is_calling && (delivery_ != Delivery::kHeld || absent_.contains(name));
    if (is_limited && IsAwaited(participant)) {
      if (Status end = ApplyLimit(name, participant, now); !end.ok()) return end.error();
    }
    if (!IsAwaited(participant)) continue;
    names.push_back(name.second);
    has_new = has_new || participant.answer == Answer::kNeverHeard;
  }
  if (has_new && delivery_ != Delivery::kUnknown && now - published_at_ > kFirstAnswers &&
      !std::exchange(has_reported_, true)) {
    const bool may_be_timer = options_.limit <= 0.0 && time_stands_ &&
                              std::any_of(participants_.begin(), participants_.end(), [this](const auto& entry) {
                                return IsAwaited(entry.second) && entry.second.reads_clock_since;
                              });
    report_(fmt::format("tick {} waits for {}{}; docs/ros2-lockstep.md", tick_, fmt::join(names, ", "),
                        may_be_timer ? "; a timer of simulated time needs --ros-lockstep-limit to start" : ""));
  }
  return names;
}

std::string TickAnswers::CallsThatWait() const {
  std::string names;
  for (const auto& [name, participant] : participants_) {
    if (participant.is_calling) names += (names.empty() ? "; for it waits a call of " : ", ") + name.second;
  }
  return names;
}

Status TickAnswers::ApplyLimit(const Name& name, Participant& participant, double now) {
  const double waited = now - std::max(published_at_, participant.called_until);
  const auto& since = participant.reads_clock_since;
  if (time_stands_ && since && std::min(waited, now - *since) > options_.limit) {
    participant.follows_time = true;
    report_(
        fmt::format("tick {} continues without {}, which is silent: its node reads /clock, and its timers are due "
                    "when the time has advanced",
                    tick_, name.second));
  } else if (participant.answer == Answer::kAwaited && waited > options_.limit) {
    if (options_.ends_at_limit) {
      return Failure(fmt::format("tick {} has waited {:.1f} s for {} of ROS (--ros-lockstep-limit){}", tick_, waited,
                                 name.second, CallsThatWait()));
    }
    participant.answer = Answer::kDropped;
    participant.waited_seconds += waited;
    ++drops_;
    report_(fmt::format("tick {} continues after {:.1f} s without {}, until that is heard of again{}", tick_, waited,
                        name.second, CallsThatWait()));
  }
  return {};
}

void TickAnswers::Release() {
  stage_ = Stage::kIdle;
  released_ = tick_;
}

std::vector<SlowRobot> TickAnswers::Slowest() const {
  std::vector<SlowRobot> slowest;
  for (const auto& [name, participant] : participants_) {
    slowest.push_back({name.second, participant.times_last, participant.waited_seconds});
  }
  std::stable_sort(slowest.begin(), slowest.end(),
                   [](const SlowRobot& a, const SlowRobot& b) { return a.waited_seconds > b.waited_seconds; });
  return slowest;
}

}  // namespace troupe
