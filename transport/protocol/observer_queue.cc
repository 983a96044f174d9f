#include "transport/protocol/observer_queue.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();
constexpr std::chrono::milliseconds kGatherTime(1);

}  // namespace

ObserverQueue::ObserverQueue(ObserverHandler& handler, std::function<void()> on_idle, double idle_seconds)
    : handler_(handler), on_idle_(std::move(on_idle)), idle_seconds_(idle_seconds), thread_([this] { Run(); }) {}

void ObserverQueue::Close() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void ObserverQueue::PostSession(SessionPointer session) {
  Post(std::move(session), kUnlimited);
}

void ObserverQueue::PostFrame(SharedFrame frame) {
  Post(std::move(frame), kFramesQueued);
}

void ObserverQueue::PostStatus(StatusPointer status) {
  Post(std::move(status), 1);
}

void ObserverQueue::PostServiceGone() {
  Post(ServiceGone{}, kUnlimited);
}

void ObserverQueue::Post(Message message, std::size_t limit) {
  bool wake = false;
  {
    const std::lock_guard lock(mutex_);
    const auto is_of_kind = [kind = message.index()](const Message& other) { return other.index() == kind; };
    if (messages_.size() >= limit &&
        std::count_if(messages_.begin(), messages_.end(), is_of_kind) >= static_cast<std::ptrdiff_t>(limit)) {
      messages_.erase(std::find_if(messages_.begin(), messages_.end(), is_of_kind));
    }
    messages_.push_back(std::move(message));
    wake = std::exchange(waiting_, false);
  }
  if (wake) changed_.notify_one();
}

void ObserverQueue::Deliver(const Message& message) {
  if (const auto* session = std::get_if<SessionPointer>(&message)) {
    handler_.OnSession(**session);
  } else if (const auto* frame = std::get_if<SharedFrame>(&message)) {
    handler_.OnFrame(*frame);
  } else if (const auto* status = std::get_if<StatusPointer>(&message)) {
    handler_.OnStatus(**status);
  } else {
    handler_.OnServiceGone();
  }
}

void ObserverQueue::Run() {
  const std::chrono::duration<double> idle(idle_seconds_);
  const auto has_work = [this] { return ending_ || !messages_.empty(); };
  std::unique_lock lock(mutex_);
  while (!ending_) {
    if (messages_.empty()) {
      waiting_ = true;
      bool idle_for_long = false;
      if (on_idle_) {
        idle_for_long = !changed_.wait_for(lock, idle, has_work);
      } else {
        changed_.wait(lock, has_work);
      }
      waiting_ = false;
      if (idle_for_long) {
        lock.unlock();
        on_idle_();
        lock.lock();
        continue;
      }
      changed_.wait_for(lock, kGatherTime, [this] { return ending_; });
      continue;
    }
    const Message next = std::move(messages_.front());
    messages_.pop_front();
    lock.unlock();
    Deliver(next);
    lock.lock();
  }
}

}  // namespace troupe
