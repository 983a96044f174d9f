#include "ros/service_bridge/pending_calls.h"

#include <algorithm>

namespace troupe::ros {
namespace {

// The first time after which a request is sent again; each next one is twice as long.
constexpr std::chrono::milliseconds kFirstRepeat{100};
constexpr int kMostSent = 8;  // the last after 13 s: discovery takes no longer

}  // namespace

void PendingCalls::Add(std::int64_t number, const Caller& caller, Bytes request, Time now) {
  bytes_ += request.size();
  calls_[number] = {caller, std::move(request), now, now, 0};
  while (calls_.size() > kMost || (bytes_ > kMostBytes && calls_.size() > 1)) Erase(calls_.begin());
}

std::optional<Caller> PendingCalls::TakeCaller(std::int64_t number) {
  const auto found = calls_.find(number);
  if (found == calls_.end()) return std::nullopt;
  const Caller caller = found->second.caller;
  Erase(found);
  return caller;
}

void PendingCalls::Forget(const Guid& endpoint) {
  for (auto call = calls_.begin(); call != calls_.end();) {
    call = call->second.caller.endpoint == endpoint ? Erase(call) : std::next(call);
  }
}

std::optional<PendingCalls::Time> PendingCalls::NextDue() const {
  std::optional<Time> next;
  for (const auto& [number, call] : calls_) {
    if (!call.due) continue;
    const Time due = call.sent == 0 ? call.came + kWaitForReader : *call.due;
    next = std::min(next.value_or(due), due);
  }
  return next;
}

void PendingCalls::NoteSent(Call& call, Time now) {
  ++call.sent;
  if (answers_ || call.sent >= kMostSent) return DropRequest(call);
  call.due = now + kFirstRepeat * (1 << (call.sent - 1));
}

void PendingCalls::DropRequest(Call& call) {
  bytes_ -= call.request.size();
  Bytes().swap(call.request);
  call.due.reset();
}

PendingCalls::Calls::iterator PendingCalls::Erase(Calls::iterator call) {
  bytes_ -= call->second.request.size();
  return calls_.erase(call);
}

}  // namespace troupe::ros
