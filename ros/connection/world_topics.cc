#include "ros/connection/world_topics.h"

#include <algorithm>
#include <exception>

#include "common/base/text.h"
#include "common/spatial/occupancy_grid.h"
#include "ros/connection/ros_network.h"
#include "ros/messages/convert.h"
#include "transport/dds/binding/wire.h"

namespace troupe::ros {
namespace {

constexpr std::int32_t kClockDepth = 10;
constexpr std::size_t kMaxLine = 2000;  // bytes, of the log
// So that a node that starts in a pause learns the time.
constexpr auto kRepeatPeriod = std::chrono::milliseconds(200);
constexpr std::int64_t kNsPerSecond = 1'000'000'000;

// Loggers of ROS use the time of the system, not the simulated one.
Time SystemTime() {
  using std::chrono::nanoseconds;
  const auto now = std::chrono::duration_cast<nanoseconds>(std::chrono::system_clock::now().time_since_epoch());
  constexpr std::int64_t kSecond = 1'000'000'000;
  return {static_cast<std::int32_t>(now.count() / kSecond), static_cast<std::uint32_t>(now.count() % kSecond)};
}

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
  // Not over a pause or a reset, which say nothing about the speed.
  if (interval_ns_ > 0 && !stays_ && ns > tick_ns_ && now > shown_at_) {
    const std::chrono::duration<double, std::nano> elapsed = now - shown_at_;
    speed = static_cast<double>(ns - tick_ns_) / elapsed.count();
  }
  // In a wait for the next tick the thread sleeps for the longer period.
  const bool wakes = interval_ns_ == 0 || Advances(stays_, speed_) != Advances(stays, speed) || AwaitsTick();
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
  const bool waits = !Advances(stays_, speed_) || AwaitsTick();
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

void WriteMap(RosWriter<OccupancyGridMessage>& writer, const Scene& scene, const WorldTopics& topics) {
  const OccupancyGrid grid =
      MakeOccupancyGrid(scene, topics.map_resolution, topics.map_height.value_or(UsualMapHeight(scene)));
  dds::WireArena arena;
  writer.Write(MakeMap(grid, arena));
}

MapOutput::MapOutput(const RosNode& node, const WorldTopics& topics)
    : connection_(*node.connection), topics_(topics), map_(node, "/map", Latched()) {}

MapOutput::~MapOutput() {
  Join();
}

void MapOutput::Join() {
  if (thread_.joinable()) thread_.join();
}

void MapOutput::ChangeWorld(const Scene& scene) {
  Join();
  scene_ = &scene;
  written_ = false;
}

void MapOutput::Poll() {
  if (written_ || scene_ == nullptr || !map_.wanted()) return;
  // Before the thread begins, which takes it back if it fails.
  written_ = true;
  Join();
  thread_ = std::thread([this] {
    try {
      WriteMap(map_, *scene_, topics_);
      connection_.Flush();
    } catch (const std::exception&) {  // as without memory: at the next Poll
      written_ = false;
    }
  });
}

RosLog::RosLog(const RosNode& node) : writer_(node, "/rosout", LogLines()) {}

void RosLog::Write(LogLevel level, const std::string& node, const std::string& text) {
  dds::WireArena arena;
  rcl_interfaces_msg_dds__Log_ line{};
  line.stamp = SystemTime();
  line.level = static_cast<std::uint8_t>(level);
  line.name = arena.Copy(LoggerName(node));
  line.msg = arena.Copy(CutUtf8(text, kMaxLine));  // it may have texts of peers
  line.file = arena.Copy("");
  line.function = arena.Copy("");
  writer_.Write(line);
}

std::string LoggerName(const std::string& node) {
  std::string name = node.substr(node.starts_with("/") ? 1 : 0);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

}  // namespace troupe::ros
