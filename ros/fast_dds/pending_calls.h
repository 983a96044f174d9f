// PendingCalls: the calls of one service that wait for their response. A call is sent on once its response would reach
// the client. Without DDS. Not safe for several threads.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "ros/fast_dds/rtps_datagram.h"

namespace troupe::ros {

// `Endpoint`: the identity of the client's reader of responses; of Fast DDS before Humble: of its writer of requests.
template <typename Endpoint>
class PendingCalls {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // A hostile client can make any number of calls: beyond these the oldest gets no response.
  static constexpr std::size_t kMaxCalls = 1000;
  // And that many bytes of requests that are not sent yet.
  static constexpr std::size_t kMaxBytes = 64U << 20U;
  // A call whose client has no reader of responses is dropped after this time.
  static constexpr std::chrono::seconds kWaitForReader{30};

  // The address of a response at the client.
  struct Caller {
    Endpoint endpoint;
    std::int64_t number = 0;
  };

  // `number` grows from call to call.
  void Add(std::int64_t number, const Caller& caller, Bytes request, Time now) {
    bytes_ += request.size();
    calls_.emplace(number, Call{caller, std::move(request), now, false});
    const auto is_over = [&] {
      const Call& oldest = calls_.begin()->second;
      return calls_.size() > kMaxCalls || (bytes_ > kMaxBytes && calls_.size() > 1) ||
             (!oldest.sent && now >= oldest.came + kWaitForReader);
    };
    while (!calls_.empty() && is_over()) Erase(calls_.begin());
  }

  // Calls `send(number, request)` with each call that was not sent and for which `can_respond(endpoint)`.
  template <typename CanRespond, typename Send>
  void SendReady(const CanRespond& can_respond, const Send& send) {
    for (auto& [number, call] : calls_) {
      if (call.sent || !can_respond(call.caller.endpoint)) continue;
      send(number, std::as_const(call.request));
      call.sent = true;
      bytes_ -= call.request.size();
      Bytes().swap(call.request);
    }
  }

  // The caller whose response this is; nothing if it has it, or is forgotten.
  std::optional<Caller> RemoveCaller(std::int64_t number) {
    const auto found = calls_.find(number);
    if (found == calls_.end()) return std::nullopt;
    const Caller caller = found->second.caller;
    Erase(found);
    return caller;
  }
  // An endpoint has left.
  void Forget(const Endpoint& endpoint) {
    for (auto call = calls_.begin(); call != calls_.end();) {
      call = call->second.caller.endpoint == endpoint ? Erase(call) : std::next(call);
    }
  }
  std::size_t size() const { return calls_.size(); }

 private:
  struct Call {
    Caller caller;
    Bytes request;  // empty once it is sent
    Time came;
    bool sent = false;
  };
  using Calls = std::map<std::int64_t, Call>;

  typename Calls::iterator Erase(typename Calls::iterator call) {
    bytes_ -= call->second.request.size();
    return calls_.erase(call);
  }

  Calls calls_;  // by number, so that the first is the oldest
  std::size_t bytes_ = 0;
};

}  // namespace troupe::ros
