#include "world-service/observers/recorder/recording_thread.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "common/base/or_failure.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// A run that is killed loses no more than the ticks of about this time.
constexpr std::chrono::duration<double> kLongestDelay(1.0);
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

RecordingThread::RecordingThread(RecordingWriter writer, Options options)
    : options_(std::move(options)), writer_(std::move(writer)), chunk_ended_(Clock::now()) {}

RecordingThread::~RecordingThread() {
  (void)Close();
}

void RecordingThread::Start() {
  const std::lock_guard lock(mutex_);
  if (!thread_.joinable()) thread_ = std::thread([this] { Run(); });
}

bool RecordingThread::has_room() const {
  const std::lock_guard lock(mutex_);
  return !full_ || !status_.ok();
}

RecordedTick RecordingThread::Reuse() {
  const std::lock_guard lock(mutex_);
  if (spare_.empty()) return {};
  RecordedTick tick = std::move(spare_.back());
  spare_.pop_back();
  return tick;
}

void RecordingThread::Push(RecordedTick tick) {
  const std::size_t size = SizeOf(tick);
  {
    const std::lock_guard lock(mutex_);
    if (!status_.ok()) return;
    entries_.push_back({std::move(tick), size});
    size_ += size;
    full_ = full_ || size_ >= options_.queue_bytes;
    ++pushed_;
  }
  changed_.notify_all();
}

Status RecordingThread::Flush() {
  std::unique_lock lock(mutex_);
  const std::uint64_t ticks = pushed_;
  flush_asked_ = std::max(flush_asked_, ticks);
  changed_.notify_all();
  changed_.wait(lock, [&] { return flushed_ >= ticks || !status_.ok(); });
  return status_;
}

Status RecordingThread::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  return status();
}

Status RecordingThread::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void RecordingThread::Fail(const Error& error) {
  {
    const std::lock_guard lock(mutex_);
    if (status_.ok()) status_ = error;
  }
  changed_.notify_all();
}

void RecordingThread::Run() {
  bool closed = false;
  while (!closed) {
    std::optional<Work> work = Await();
    if (!work) return;
    const Status written = OrFailure([&] { return Write(*work); });
    if (!written.ok()) return Fail(written.error());
    closed = work->closes;
    Finish(std::move(*work));
  }
}

std::optional<RecordingThread::Work> RecordingThread::Await() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kLongestDelay,
                    [this] { return closed_ || !entries_.empty() || flush_asked_ > flushed_ || !status_.ok(); });
  if (!status_.ok()) return std::nullopt;
  Work work;
  if (!entries_.empty()) {
    work.tick = std::move(entries_.front().tick);
    size_ -= entries_.front().size;
    entries_.pop_front();
    ++popped_;
    if (size_ <= options_.queue_bytes / 2) full_ = false;
  } else {
    work.closes = closed_;
  }
  work.flushes = work.closes || Clock::now() - chunk_ended_ >= kLongestDelay ||
                 (flush_asked_ > flushed_ && popped_ >= flush_asked_);
  return work;
}

Status RecordingThread::Write(const Work& work) {
  Status written = work.tick ? writer_.Add(*work.tick) : Status();
  if (written.ok() && work.flushes) {
    written = writer_.EndChunk();
    chunk_ended_ = Clock::now();
  }
  if (written.ok() && writer_.first_unwritten() != first_unwritten_) {
    first_unwritten_ = writer_.first_unwritten();
    if (options_.sync) written = writer_.Sync();
    if (written.ok() && options_.on_written) options_.on_written(first_unwritten_);
  }
  if (!written.ok() || !work.closes) return written;
  written = writer_.Close();
  if (written.ok() && options_.on_closed) options_.on_closed();
  return written;
}

void RecordingThread::Finish(Work work) {
  if (work.tick) {
    work.tick->proposals.clear();
    work.tick->events.clear();
    work.tick->edit.reset();
    work.tick->keyframe.reset();
  }
  {
    const std::lock_guard lock(mutex_);
    if (work.tick && spare_.size() < kMostSpare) spare_.push_back(std::move(*work.tick));
    if (!work.flushes) return;
    flushed_ = popped_;
  }
  changed_.notify_all();
}

}  // namespace troupe
