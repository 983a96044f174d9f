// A node of ROS for which ticks wait, and runs that wait for it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <functional>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "ros/connection/node_services.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/ros_participant.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/wire.h"

namespace troupe::test {

// The way in which ticks wait for the node: for its commands to each scan, for its answers on /world/tick_done, for
// its commands by a timer of simulated time; or for its commands to each scan, which depend on the number of scans that
// it has received, as those of a node with a filter. A node on its topic knows nothing of ticks.
enum class Way { kTopic, kProtocol, kTimer, kCounter };
inline constexpr std::array<const char*, 4> kWays = {"topic", "protocol", "timer", "counter"};

struct NodeOptions {
  Way way = Way::kProtocol;
  std::string name = "driver";
  std::string space = "/r0";  // of the robot's topics
  int least_delay = 0;        // ms before an answer, drawn
  int most_delay = 0;
  unsigned seed = 1;           // of the delays
  bool has_parameters = true;  // their services, as of each node of rclcpp and rclpy
  std::uint32_t domain = TestRosNetwork().domain;
  std::string interface = "lo";
  bool logs = false;  // prints the scans that it has answered
};

// A node that drives a robot by its scan: the same scan gives the same command.
class LockstepNode {
 public:
  explicit LockstepNode(const NodeOptions& options)
      : options_(options), participant_(RosNetworkOf(options)), thread_([this] { Run(); }) {}
  ~LockstepNode() {
    stop_ = true;
    Notify();
    thread_.join();
  }
  LockstepNode(const LockstepNode&) = delete;
  LockstepNode& operator=(const LockstepNode&) = delete;

  // It answers no tick from this one on, until Continue.
  void HaltAt(Tick tick) { halt_at_ = tick; }
  void Continue() {
    halt_at_ = kNever;
    Notify();
  }
  // Says of a tick at which it halts that it makes no call before others.
  void WaitForOthers() { waits_for_others_ = true; }
  // Answers beside its own, which no tick may count.
  void SendWrongAnswers() { is_wrong_ = true; }
  const ros::RosParticipant& participant() const { return participant_; }
  // The newest tick that it knows of, and that it has answered.
  std::optional<Tick> shown() const {
    const Tick tick = shown_;
    return tick == kNever ? std::nullopt : std::optional(tick);
  }
  Tick answered() const { return answered_; }
  std::size_t answers() const { return answers_; }
  std::string lists() {
    const std::lock_guard lock(mutex_);
    return lists_;
  }

 private:
  static constexpr Tick kNever = 1'000'000'000;

  static ros::RosNetwork RosNetworkOf(const NodeOptions& options) {
    ros::RosNetwork network = InDomain(options.domain);
    network.network_interface = options.interface;
    network.service_clients = ros::ServiceClients::kCyclone;
    return network;
  }
  // A timer with the period of the ticks, as rclcpp and rclpy have it: due a period after the time at which it is made,
  // or to which the clock jumps back.
  class Timer {
   public:
    Timer(const ros::RosNode& node, const std::function<void()>& notify)
        : clock_(node, "/clock", ros::Stream(10), ros::Part::kOnlyReader, notify) {}

    bool IsDue() {
      clock_.Drain([this](const ros::Clock& clock) {
        const Tick before = std::exchange(now_, TickOf(clock.clock));
        if (now_ < before) next_ = now_ + 1;
      });
      if (now_ < next_) return false;
      next_ = now_ + 1;
      return true;
    }
    Tick tick() const { return now_; }
    ros::TwistMessage command() const {
      ros::TwistMessage twist{};
      twist.linear.x = 0.3;
      twist.angular.z = 0.5 * std::sin(0.1 * static_cast<double>(now_));
      return twist;
    }

   private:
    ros::RosReader<ros::Clock> clock_;
    Tick now_ = 0;
    Tick next_ = 1;
  };

  void Notify() {
    const std::lock_guard lock(mutex_);
    arrived_ = true;
    wake_.notify_one();
  }
  static ros::TwistMessage CommandFor(const ros::LaserScan& scan) {
    const auto ranges = dds::Elements(scan.ranges);
    double right = 0.0;
    double left = 0.0;
    double ahead = 8.0;
    const std::size_t count = ranges.size();
    for (std::size_t i = 0; i < count; ++i) {
      const double range = std::min<double>(ranges[i], 8.0);
      (2 * i < count ? right : left) += range;
      if (3 * i >= count && 3 * i < 2 * count) ahead = std::min(ahead, range);
    }
    ros::TwistMessage twist{};
    twist.linear.x = ahead > 0.7 ? 0.4 : 0.0;
    twist.angular.z = std::clamp((left - right) / 20.0, -1.0, 1.0) + (ahead > 0.7 ? 0.0 : 0.5);
    return twist;
  }

  void Run() {
    const ros::RosNode node = ros::MakeNode(participant_, "/", options_.name);
    const auto notify = [this] { Notify(); };
    ros::RosReader<ros::LaserScan> scans(node, options_.space + "/scan", ros::Stream(10), ros::Part::kOnlyReader,
                                         notify);
    ros::RosReader<ros::Header> ticks(node, "/world/tick", ros::Latched(), ros::Part::kOnlyReader, notify);
    ros::RosWriter<ros::TwistMessage> commands(node, options_.space + "/cmd_vel", ros::Stream(10));
    ros::RosWriter<ros::Header> answers(node, "/world/tick_done", ros::Stream(10));
    std::optional<Timer> timer;
    if (options_.way == Way::kTimer) timer.emplace(node, notify);
    // Last, because a node of rclcpp or rclpy answers once it spins.
    std::optional<ros::ParameterServices> parameters;
    if (options_.has_parameters) parameters.emplace(node, options_.name, ros::Parameters{});
    participant_.Announce();
    std::mt19937 random(options_.seed);
    if (options_.way == Way::kTopic || options_.way == Way::kCounter) return Follow(scans, commands, random);
    std::optional<Tick> scanned;
    ros::TwistMessage command{};
    std::optional<Tick> shown;
    std::optional<ros::Time> stamp;
    bool has_scan = false;
    std::string edition;
    std::string said;          // that it waits for others, to the announcement of this edition
    std::optional<Tick> done;  // by this node
    while (!stop_) {
      {
        std::unique_lock lock(mutex_);
        wake_.wait_for(lock, std::chrono::milliseconds(200), [this] { return arrived_ || stop_; });
        arrived_ = false;
      }
      scans.Drain([&](const ros::LaserScan& scan) {
        scanned = TickOf(scan.header.stamp);
        command = CommandFor(scan);
      });
      ticks.Drain([&](const ros::Header& tick) {
        shown = TickOf(tick.stamp);
        shown_ = *shown;
        stamp = tick.stamp;
        const std::lock_guard lock(mutex_);
        lists_ = dds::Text(tick.frame_id);
        edition = lists_.substr(0, lists_.find(' '));
        has_scan = (" " + lists_).find(" " + options_.space + "/scan:") != std::string::npos;
        // The tick again is answered again. After an earlier one, as of a next run, the node knows nothing.
        if (options_.way == Way::kProtocol && done && *done >= *shown) done.reset();
      });
      if (timer) {
        if (timer->IsDue()) {
          Delay(random);
          commands.Write(timer->command());
          answered_ = timer->tick();
          ++answers_;
        }
        continue;
      }
      if (!commands.wanted()) continue;
      if (!answers.wanted() || !shown || done == shown) continue;
      if (*shown >= halt_at_) {
        const bool is_new = waits_for_others_ && std::exchange(said, edition) != edition;
        if (is_new) Answer(answers, options_.name + " " + edition + " waits", *stamp);
        continue;
      }
      if (scanned != shown && (has_scan || !done)) continue;  // of the first tick the scan is repeated for this node
      Delay(random);
      if (is_wrong_) SendWrong(answers, *shown);
      if (scanned == shown) commands.Write(command);
      Answer(answers, options_.name + " " + edition, *stamp);
      if (is_wrong_) Answer(answers, options_.name, *stamp);
      done = shown;
      answered_ = *done;
      ++answers_;
    }
  }
  // Each scan is one call of a callback, whatever its stamp, as in a node that is not written for ticks that wait.
  void Follow(ros::RosReader<ros::LaserScan>& scans, ros::RosWriter<ros::TwistMessage>& commands,
              std::mt19937& random) {
    while (!stop_) {
      {
        std::unique_lock lock(mutex_);
        wake_.wait_for(lock, std::chrono::milliseconds(200), [this] { return arrived_ || stop_; });
        arrived_ = false;
      }
      scans.Drain([&](const ros::LaserScan& scan) {
        Delay(random);
        ++answers_;
        answered_ = TickOf(scan.header.stamp);
        commands.Write(options_.way == Way::kTopic ? CommandFor(scan) : CommandAfter(answers_));
        if (options_.logs) std::printf("%zu: scan of tick %d\n", answers_.load(), static_cast<int>(answered_));
      });
    }
  }
  static ros::TwistMessage CommandAfter(std::size_t scans) {
    ros::TwistMessage twist{};
    twist.linear.x = 0.3;
    twist.angular.z = 0.5 * std::sin(0.1 * static_cast<double>(scans));
    return twist;
  }
  void Delay(std::mt19937& random) const {
    if (options_.most_delay == 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(
        std::uniform_int_distribution<int>(options_.least_delay, options_.most_delay)(random)));
  }
  static void Answer(ros::RosWriter<ros::Header>& answers, const std::string& name, const ros::Time& stamp) {
    dds::WireArena arena;
    ros::Header header{};
    header.stamp = stamp;
    header.frame_id = arena.Copy(name);
    answers.Write(header);
  }
  void SendWrong(ros::RosWriter<ros::Header>& answers, Tick tick) const {
    const auto stamp_of = [](Tick of) {
      return ros::Time{static_cast<std::int32_t>(of / 10), static_cast<std::uint32_t>(of % 10) * 100'000'000};
    };
    Answer(answers, options_.name, stamp_of(tick + 1));
    if (tick > 0) Answer(answers, options_.name, stamp_of(tick - 1));
    Answer(answers, options_.name, {-7, 4'000'000'000U});
    Answer(answers, "", stamp_of(tick));
    Answer(answers, options_.name + " edition:999999", stamp_of(tick));
    Answer(answers, options_.name + " waits waits", stamp_of(tick));
    Answer(answers, std::string(300, '\x01'), stamp_of(tick));
  }

  const NodeOptions options_;
  ros::RosParticipant participant_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool arrived_ = true;
  std::string lists_;
  std::atomic<bool> stop_ = false;
  std::atomic<bool> is_wrong_ = false;
  std::atomic<bool> waits_for_others_ = false;
  std::atomic<Tick> halt_at_ = kNever;
  std::atomic<Tick> shown_ = kNever;
  std::atomic<Tick> answered_ = 0;
  std::atomic<std::size_t> answers_ = 0;
  std::thread thread_;
};

// The node in a process of its own, which a test can stop and kill.
inline Program NodeProcess(const NodeOptions& options) {
  return Program({ProgramPath("lockstep_node"), kWays[static_cast<std::size_t>(options.way)], options.name,
                  options.space.empty() ? "/" : options.space, std::to_string(options.most_delay),
                  std::to_string(options.seed), std::to_string(options.domain), options.interface});
}

// Runs whose ticks wait for a node.
class LockstepRunTest : public testing::Test {
 protected:
  std::vector<std::string> Arguments(const std::string& prefix, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = Words("--hash-log % --session %", {folder_.Path(prefix + "hashes"), session_});
    if (std::find(more.begin(), more.end(), "--ticks") == more.end()) arguments = arguments + Words("--ticks 60");
    return RosArguments(arguments + more);
  }
  // The hashes of a run with the driver.
  std::string HashesOf(const NodeOptions& node, const std::vector<std::string>& more) {
    const std::string prefix = std::to_string(runs_++) + "-";
    LockstepNode driver(node);
    OutputOf(RunPen(Arguments(prefix, more)));
    return folder_.Read(prefix + "hashes");
  }
  // The hashes that each run with a driver has whose ticks wait for it.
  const std::string& Reference() {
    static const std::string reference = HashesOf({}, {"--ros-lockstep", "driver"});
    return reference;
  }
  ControlReply Call(const control::Request& request) const { return CallRun(session_, request); }
  // Each tick is a chain of processes, which take turns on a busy machine.
  template <typename Condition>
  static bool Eventually(Condition condition, double seconds = kSeconds) {
    return test::Eventually(condition, seconds);
  }

  TemporaryFolder folder_;
  const std::string session_ = TestSession("lockstep");
  int runs_ = 0;
};

}  // namespace troupe::test
