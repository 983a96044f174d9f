// ObserverQueue: calls an ObserverHandler on a thread of its own, so that a slow observer delays neither the service
// nor any agent. The observer endpoints of transports post to it.
//
// A message that finds the queue empty waits a moment for others: to wake a thread for every frame of a fast run would
// cost more than its handler.
//
// Invariant: messages are delivered in the order in which they were posted. At most kFramesQueued frames and one status
// wait; the newest replaces the oldest. Any thread may post, also from inside a handler call.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <variant>

#include "transport/protocol/transport.h"

namespace troupe {

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
