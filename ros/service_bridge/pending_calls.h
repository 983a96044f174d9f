// PendingCalls: the calls of one service that wait for their response, and when each is sent. Without DDS. Not safe for
// several threads.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "ros/service_bridge/call_header.h"
#include "ros/service_bridge/guid.h"

namespace troupe::ros {

// The address of a response at the client.
struct Caller {
  Guid endpoint{};  // its reader of responses; that of Fast DDS before Humble: its writer of requests
  std::int64_t number = 0;

  friend bool operator==(const Caller&, const Caller&) = default;
};

class PendingCalls {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  // A hostile client can make any number of calls: beyond these the oldest gets no response.
  static constexpr std::size_t kMost = 1000;
  // And that many bytes of requests that may have to be sent again.
  static constexpr std::size_t kMostBytes = 64U << 20U;
  // A call whose client has no reader of responses is dropped after this time.
  static constexpr std::chrono::seconds kWaitForReader{30};

  // A service is known to receive requests once it has answered one.
  void ServiceAnswers() { answers_ = true; }
  // The service has new endpoints, which may not have discovered those of the bridge yet.
  void ServiceChanges() { answers_ = false; }

  // `number` grows from call to call.
  void Add(std::int64_t number, const Caller& caller, Bytes request, Time now);

  // Calls `send(number, request)` with each call that is due. `can_respond(endpoint)`: the response would reach it.
  template <typename CanRespond, typename Send>
  void SendDue(Time now, const CanRespond& can_respond, const Send& send) {
    for (auto call = calls_.begin(); call != calls_.end();) {
      Call& entry = call->second;
      const bool is_due = entry.due && *entry.due <= now;
      const bool can_be_sent = is_due && can_respond(entry.caller.endpoint);
      if (can_be_sent) {
        send(call->first, std::as_const(entry.request));
        NoteSent(entry, now);
      }
      // Its client has left, or has no reader.
      const bool is_lost = is_due && !can_be_sent && (entry.sent > 0 || now >= entry.came + kWaitForReader);
      call = is_lost ? Erase(call) : std::next(call);
    }
  }

  // The caller whose response this is; nothing if it has it, or is forgotten.
  std::optional<Caller> TakeCaller(std::int64_t number);
  // An endpoint has left.
  void Forget(const Guid& endpoint);

  // When SendDue has something to do, unless a reader of a client comes before.
  std::optional<Time> NextDue() const;
  std::size_t size() const { return calls_.size(); }

 private:
  struct Call {
    Caller caller;
    Bytes request;  // empty once it need not be sent again
    Time came;
    std::optional<Time> due;
    int sent = 0;
  };
  using Calls = std::map<std::int64_t, Call>;

  void NoteSent(Call& call, Time now);
  void DropRequest(Call& call);
  Calls::iterator Erase(Calls::iterator call);

  bool answers_ = false;
  Calls calls_;  // by number, so that the first is the oldest
  std::size_t bytes_ = 0;
};

}  // namespace troupe::ros
