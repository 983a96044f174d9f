#include "world-service/observers/recorder/tick_queue.h"

#include <chrono>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t kMostSpare = 64;

// Nearly all of a world is its shapes.
std::size_t SizeOf(const WorldDescription& world) {
  std::size_t size = world.models.size() * sizeof(ModelDescription) + world.robots.size() * sizeof(RobotDescription);
  for (const Shape& shape : world.shapes) size += sizeof shape + shape.rectangles.size() * sizeof(Rectangle);
  return size;
}

std::size_t SizeOf(const RecordedTick& tick) {
  std::size_t size = sizeof tick + tick.proposals.size() * sizeof(Proposal) + tick.events.size() * sizeof(Event);
  for (const Proposal& proposal : tick.proposals) {
    size += proposal.joint_velocities.size() * sizeof(double);
    for (const RadioMessage& message : proposal.messages) size += sizeof message + message.bytes.size();
  }
  size += tick.commands.size() * sizeof(RobotCommand);
  if (tick.keyframe) size += MemoryOf(tick.keyframe->state);
  if (!tick.edit) return size;
  size += sizeof(RecordedEdit) + MemoryOf(tick.edit->before.state);
  if (tick.edit->world) size += SizeOf(*tick.edit->world);
  return size;
}

}  // namespace

bool TickQueue::has_room() const {
  const std::lock_guard lock(mutex_);
  return !full_;
}

RecordedTick TickQueue::Reuse() {
  const std::lock_guard lock(mutex_);
  if (spare_.empty()) return {};
  RecordedTick tick = std::move(spare_.back());
  spare_.pop_back();
  return tick;
}

void TickQueue::Push(RecordedTick tick) {
  {
    const std::size_t size = SizeOf(tick);
    const std::lock_guard lock(mutex_);
    entries_.push_back({std::move(tick), size});
    size_ += size;
    full_ = full_ || size_ >= capacity_;
  }
  changed_.notify_one();
}

std::optional<RecordedTick> TickQueue::Pop(double seconds) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                    [this] { return closed_ || interrupted_ || !entries_.empty(); });
  if (entries_.empty()) {
    interrupted_ = false;
    return std::nullopt;
  }
  Entry entry = std::move(entries_.front());
  entries_.pop_front();
  size_ -= entry.size;
  if (size_ <= capacity_ / 2) full_ = false;
  return std::move(entry.tick);
}

void TickQueue::Recycle(RecordedTick tick) {
  tick.proposals.clear();
  tick.events.clear();
  tick.edit.reset();
  tick.keyframe.reset();
  const std::lock_guard lock(mutex_);
  if (spare_.size() < kMostSpare) spare_.push_back(std::move(tick));
}

void TickQueue::Interrupt() {
  {
    const std::lock_guard lock(mutex_);
    interrupted_ = true;
  }
  changed_.notify_one();
}

void TickQueue::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_one();
}

bool TickQueue::done() const {
  const std::lock_guard lock(mutex_);
  return closed_ && entries_.empty();
}

}  // namespace troupe
