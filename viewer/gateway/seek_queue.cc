#include "viewer/gateway/seek_queue.h"

namespace troupe {

SeekQueue::SeekQueue(PastStates& states, std::function<void()> on_found)
    : states_(states), on_found_(std::move(on_found)), thread_([this] { Run(); }) {}

SeekQueue::~SeekQueue() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void SeekQueue::Add(ViewerId viewer, std::uint64_t position) {
  {
    const std::lock_guard lock(mutex_);
    wanted_[viewer] = position;
  }
  changed_.notify_all();
}

void SeekQueue::Remove(ViewerId viewer) {
  const std::lock_guard lock(mutex_);
  wanted_.erase(viewer);
}

std::vector<SeekQueue::Found> SeekQueue::TakeFound() {
  const std::lock_guard lock(mutex_);
  return std::exchange(found_, {});
}

void SeekQueue::Run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return ending_ || !wanted_.empty(); });
    if (ending_) return;
    const auto [viewer, position] = *wanted_.begin();
    wanted_.erase(wanted_.begin());
    lock.unlock();
    Result<std::shared_ptr<const PastState>> state = states_.At(position);
    lock.lock();
    found_.push_back({viewer, std::move(state)});
    on_found_();
  }
}

}  // namespace troupe
