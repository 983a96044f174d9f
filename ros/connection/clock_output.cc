#include "ros/connection/clock_output.h"

#include <algorithm>

#include "ros/connection/ros_qos.h"

namespace troupe::ros {
namespace {

constexpr std::int32_t kClockDepth = 10;
// So that a node that starts in a pause learns the time.
constexpr auto kRepeatPeriod = std::chrono::milliseconds(200);
constexpr std::int64_t kNsPerSecond = 1'000'000'000;

}  // namespace

ClockOutput::ClockOutput(const RosNode& node, double rate)
    : connection_(*node.connection),
      rate_(rate),
      writer_(node, "/clock", Stream(kClockDepth)),
      thread_([this] { Run(); }) {}

ClockOutput::~ClockOutput() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void ClockOutput::Show(Tick tick, std::int64_t interval_ns, bool stays) {
  const std::int64_t ns = static_cast<std::int64_t>(tick) * interval_ns;
  const auto now = WallClock::now();
  const std::lock_guard lock(mutex_);
  std::optional<double> speed = speed_;
  if (interval_ns_ > 0 && !stays_ && ns > tick_ns_ && now > shown_at_) {
    const std::chrono::duration<double, std::nano> elapsed = now - shown_at_;
    speed = static_cast<double>(ns - tick_ns_) / elapsed.count();
  }
  const bool wakes = interval_ns_ == 0 || Advances(stays_, speed_) != Advances(stays, speed);
  if (ns < tick_ns_) written_ns_ = ns;  // a reset
  tick_ns_ = ns;
  interval_ns_ = interval_ns;
  stays_ = stays;
  speed_ = speed;
  shown_at_ = now;
  Write(ns, now);
  if (wakes) changed_.notify_one();
}

void ClockOutput::Run() {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    if (interval_ns_ == 0) {
      changed_.wait(lock);
      continue;
    }
    if (const auto now = WallClock::now(); now >= NextWrite()) {
      Write(TimeAt(now), now);
      connection_.Flush();
    } else {
      changed_.wait_until(lock, NextWrite());
    }
  }
}

ClockOutput::WallClock::time_point ClockOutput::NextWrite() const {
  const bool waits = !Advances(stays_, speed_) || written_ns_ >= tick_ns_ + interval_ns_;  // for the next tick
  const std::chrono::duration<double> period = waits ? kRepeatPeriod : std::chrono::duration<double>(1.0 / rate_);
  return written_at_ + std::chrono::duration_cast<WallClock::duration>(period);
}

std::int64_t ClockOutput::TimeAt(WallClock::time_point now) const {
  if (!Advances(stays_, speed_)) return tick_ns_;
  const std::chrono::duration<double> elapsed = now - shown_at_;
  const double ns = elapsed.count() * *speed_ * static_cast<double>(kNsPerSecond);
  return tick_ns_ + static_cast<std::int64_t>(std::min(ns, static_cast<double>(interval_ns_)));
}

void ClockOutput::Write(std::int64_t ns, WallClock::time_point now) {
  written_ns_ = std::max(written_ns_, ns);
  written_at_ = now;
  if (!writer_.wanted()) return;
  writer_.Write({{static_cast<std::int32_t>(written_ns_ / kNsPerSecond),
                  static_cast<std::uint32_t>(written_ns_ % kNsPerSecond)}});
}

}  // namespace troupe::ros
