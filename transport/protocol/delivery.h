// The threads that deliver messages: one for all targets of a transport, and one for a slow observer.
//
// DeliveryThread serves MemoryTransport and FaultyTransport; ObserverQueue serves the observers of all transports.
// Calls are made without a lock held, so that they may post, add and remove. A message to an observer for which there
// is no memory is lost.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <variant>

#include "transport/protocol/transport.h"

namespace troupe {

// DeliveryThread: one thread that makes calls for its targets, one at a time, in the order in which they were posted or
// when their delay is over. Made for transports: a target is the receiving end of one endpoint.
//
// Any thread may call, also from inside a call that is being delivered.
class DeliveryThread {
 public:
  using Target = std::uint64_t;

  DeliveryThread();
  ~DeliveryThread();  // drops the queued calls
  DeliveryThread(const DeliveryThread&) = delete;
  DeliveryThread& operator=(const DeliveryThread&) = delete;

  Target AddTarget();
  // Drops the calls queued for the target. When it returns, none of the target's calls runs, but the one that calls
  // this.
  void RemoveTarget(Target target);

  void Post(Target target, std::function<void()> call, double delay_seconds = 0.0);

  // Waits until nothing is queued without delay and no call runs, at most `seconds`. Returns at once inside a call.
  void WaitUntilIdle(double seconds);

 private:
  using Clock = std::chrono::steady_clock;
  struct Call {
    Target target;
    std::function<void()> call;
  };

  void Run();
  // Moves the calls that are due from later_ to now_.
  void QueueDue();

  std::mutex mutex_;
  std::condition_variable work_;  // something was posted, or it is time to end
  std::condition_variable done_;  // a call ended
  std::deque<Call> now_;
  std::multimap<Clock::time_point, Call> later_;
  std::set<Target> targets_;
  std::optional<Target> running_;  // the target of the running call
  Target next_target_ = 1;
  bool ending_ = false;
  std::thread thread_;  // last, so that it starts when all other members exist
};

// ObserverQueue: calls an ObserverHandler on a thread of its own, so that a slow observer delays neither the service
// nor any agent. The observer endpoints of transports post to it.
//
// A message that finds the queue empty waits a moment for others: to wake a thread for every frame of a fast run would
// cost more than its handler.
//
// Invariant: messages are delivered in the order in which they were posted. At most kFramesQueued frames and one status
// wait; the newest replaces the oldest. Any thread may post, also from inside a handler call.
class ObserverQueue {
 public:
  // Enough for an observer that is not scheduled for a moment; few, so that a slow one does not lag far behind.
  static constexpr std::size_t kFramesQueued = 64;

  // `on_idle` is called, on the thread of the queue, whenever nothing was posted for `idle_seconds`; it may be empty.
  // REQUIRES: the handler outlives the queue.
  explicit ObserverQueue(ObserverHandler& handler, std::function<void()> on_idle = {}, double idle_seconds = 0.0);
  ~ObserverQueue() { Close(); }
  ObserverQueue(const ObserverQueue&) = delete;
  ObserverQueue& operator=(const ObserverQueue&) = delete;

  void PostSession(std::shared_ptr<const SessionMessage> session);
  void PostFrame(SharedFrame frame);
  void PostStatus(std::shared_ptr<const StatusMessage> status);
  void PostServiceGone();

  // Drops the messages that wait. No handler call runs any more when it returns, and later messages are never
  // delivered. REQUIRES: not called from inside a handler call.
  void Close();

 private:
  struct ServiceGone {};
  using SessionPointer = std::shared_ptr<const SessionMessage>;
  using StatusPointer = std::shared_ptr<const StatusMessage>;
  using Message = std::variant<SessionPointer, SharedFrame, StatusPointer, ServiceGone>;

  // Appends the message; of its kind at most `limit` wait.
  void Post(Message message, std::size_t limit);
  void Deliver(const Message& message);
  void Run();

  ObserverHandler& handler_;
  const std::function<void()> on_idle_;
  const double idle_seconds_;
  std::mutex mutex_;  // guards the members below it
  std::condition_variable changed_;
  std::deque<Message> messages_;
  bool waiting_ = false;  // the thread waits for a message
  bool ending_ = false;
  std::thread thread_;  // last, so that it starts when all other members exist
};

}  // namespace troupe
