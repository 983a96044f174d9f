#include "transport/protocol/delivery.h"

#include <algorithm>
#include <limits>
#include <new>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();
constexpr std::chrono::milliseconds kGatherTime(1);

}  // namespace

DeliveryThread::DeliveryThread() : thread_([this] { Run(); }) {}

DeliveryThread::~DeliveryThread() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  work_.notify_one();
  thread_.join();
}

DeliveryThread::Target DeliveryThread::AddTarget() {
  const std::lock_guard lock(mutex_);
  targets_.insert(next_target_);
  return next_target_++;
}

void DeliveryThread::RemoveTarget(Target target) {
  std::unique_lock lock(mutex_);
  targets_.erase(target);
  // The target removes itself from inside one of its calls: waiting for the end of that call would never end.
  if (std::this_thread::get_id() == thread_.get_id()) return;
  done_.wait(lock, [&] { return running_ != target; });
}

void DeliveryThread::Post(Target target, std::function<void()> call, double delay_seconds) {
  {
    const std::lock_guard lock(mutex_);
    if (delay_seconds > 0.0) {
      const auto delay = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(delay_seconds));
      later_.emplace(Clock::now() + delay, Call{target, std::move(call)});
    } else {
      now_.push_back({target, std::move(call)});
    }
  }
  work_.notify_one();
}

void DeliveryThread::WaitUntilIdle(double seconds) {
  if (std::this_thread::get_id() == thread_.get_id()) return;
  std::unique_lock lock(mutex_);
  done_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return now_.empty() && !running_; });
}

void DeliveryThread::QueueDue() {
  if (later_.empty()) return;
  // In the order of their times; of equal times in that of Post.
  const auto end = later_.upper_bound(Clock::now());
  for (auto due = later_.begin(); due != end; ++due) now_.push_back(std::move(due->second));
  later_.erase(later_.begin(), end);
}

void DeliveryThread::Run() {
  std::unique_lock lock(mutex_);
  while (!ending_) {
    QueueDue();
    if (now_.empty()) {
      done_.notify_all();
      if (later_.empty()) {
        work_.wait(lock);
      } else {
        work_.wait_until(lock, later_.begin()->first);
      }
      continue;
    }
    Call next = std::move(now_.front());
    now_.pop_front();
    // The target was removed while the call waited.
    if (!targets_.contains(next.target)) continue;
    running_ = next.target;
    lock.unlock();
    // Without the lock: a call may post, and may add or remove targets.
    next.call();
    next.call = nullptr;  // destroys the function and its captures while the target still exists
    lock.lock();
    running_.reset();
    done_.notify_all();
  }
}

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
    // The cheap test first: the count is linear, and queues are mostly short.
    if (messages_.size() >= limit &&
        std::count_if(messages_.begin(), messages_.end(), is_of_kind) >= static_cast<std::ptrdiff_t>(limit)) {
      // The oldest of its kind: the newest is of more use, and the order of the others stays.
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
      // A burst of messages wakes the thread once, not once for each.
      changed_.wait_for(lock, kGatherTime, [this] { return ending_; });
      continue;
    }
    const Message next = std::move(messages_.front());
    messages_.pop_front();
    lock.unlock();
    try {
      Deliver(next);
    } catch (const std::bad_alloc&) {
      lock.lock();
      continue;  // the message is lost, as one for which there is no room
    }
    lock.lock();
  }
}

}  // namespace troupe
