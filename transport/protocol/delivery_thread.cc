#include "transport/protocol/delivery_thread.h"

#include <utility>

namespace troupe {

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
    if (!targets_.contains(next.target)) continue;
    running_ = next.target;
    lock.unlock();
    next.call();
    next.call = nullptr;  // destroys the function and its captures while the target still exists
    lock.lock();
    running_.reset();
    done_.notify_all();
  }
}

}  // namespace troupe
