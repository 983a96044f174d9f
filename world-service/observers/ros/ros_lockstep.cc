#include "world-service/observers/ros/ros_lockstep.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <set>
#include <utility>

#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"
#include "ros/messages/names.h"
#include "transport/dds/binding/wire.h"

namespace troupe {
namespace {

constexpr const char* kTickTopic = "/world/tick";
constexpr const char* kDoneTopic = "/world/tick_done";
constexpr std::int32_t kAnswerDepth = 1000;  // of many nodes
constexpr std::int64_t kNsPerSecond = 1'000'000'000;

// Wall times, s.
constexpr double kFirstAnswers = 5.0;  // until a notice of those that have never answered
constexpr double kMaxArming = 1.0;     // of a program that does not answer

double SecondsSince(std::chrono::steady_clock::time_point time) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - time).count();
}

ros::TopicSpec SpecOf(const char* topic, const ros::TopicQos& qos) {
  return {std::string("rt") + topic, dds::TopicTraits<ros::Header>::descriptor(), qos};
}

}  // namespace

// One ROS domain.
struct RosLockstepWait::Channel {
  Channel(std::uint32_t domain_of_channel, std::unique_ptr<ros::HostConnection> own_connection,
          ros::HostConnection& used)
      : domain(domain_of_channel),
        own(std::move(own_connection)),
        connection(used),
        ticks(used.MakeWriter(ros::kNoNode, SpecOf(kTickTopic, ros::Latched()))),
        answers(
            used.MakeReader(ros::kNoNode, SpecOf(kDoneTopic, ros::Stream(kAnswerDepth)), ros::Part::kOnlyReader, {})) {}

  const std::uint32_t domain;
  const std::unique_ptr<ros::HostConnection> own;  // null: that of the run
  ros::HostConnection& connection;
  const std::unique_ptr<ros::TopicWriter> ticks;
  const std::unique_ptr<ros::TopicReader> answers;
  std::vector<Awaited> awaited;
  // Of the tick that awaits answers: not yet given to the connection; given to it; told to the nodes of the domain,
  // before all that arrives from then on.
  enum class Announcement : std::uint8_t { kPending, kGiven, kTold };
  Announcement announcement = Announcement::kPending;

  bool is_told() const { return announcement == Announcement::kTold; }
};

RosLockstepWait::RosLockstepWait(ros::HostConnection& of_run, const ros::RosOptions& options,
                                 std::shared_ptr<const Scene> scene, RunId run, WorldControl& control, Hooks hooks)
    : of_run_(of_run),
      options_(options),
      run_(run),
      period_(options.lockstep.period.value_or(1)),
      limit_(options.lockstep.limit_seconds.value_or(RosLockstep::kDefaultLimitSeconds)),
      ends_at_limit_(options.lockstep.ends_at_limit.value_or(true)),
      control_(control),
      hooks_(std::move(hooks)),
      reports_(hooks_.report),
      scene_(std::move(scene)) {
  of_run_.WatchTopics([this] {
    OnArrival();
    hooks_.on_arrival();
  });
  thread_ = std::thread([this] { Run(); });
}

RosLockstepWait::~RosLockstepWait() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    changed_.notify_one();
  }
  thread_.join();
  of_run_.WatchTopics({});
  std::vector<std::unique_ptr<Channel>> ended;  // without the mutex: their threads may wait for it
  const std::lock_guard lock(mutex_);
  ended.swap(channels_);
}

void RosLockstepWait::OnWorldChange(std::shared_ptr<const Scene> scene) {
  const std::lock_guard lock(mutex_);
  scene_ = std::move(scene);
  follow_ = true;
  changed_.notify_one();
}

std::string RosLockstepWait::TextOf(Edition edition, Tick tick) const {
  return fmt::format("{:016x} {} {}", run_, edition, tick);
}

// A message counts for a tick from before the agents see its frame on.
void RosLockstepWait::OnCommit(const FrameMessage& frame) {
  const std::lock_guard lock(mutex_);
  awaits_answers_ = false;
  if (frame.paused && ShowsTick(frame.state.tick)) Arm(TextOf(frame.edition, frame.state.tick));
}

void RosLockstepWait::OnShown(const FrameMessage& frame) {
  if (!ShowsTick(frame.state.tick)) return;
  const std::lock_guard lock(mutex_);
  edition_ = frame.edition;
  tick_ = frame.state.tick;
  interval_ns_ = scene_->world().interval_ns;
  published_at_ = Clock::now();
  awaits_answers_ = true;
  Arm(TextOf(edition_, tick_));  // of a run that is continued
  for (const auto& channel : channels_) {
    channel->announcement = Channel::Announcement::kPending;
    for (Awaited& awaited : channel->awaited) awaited.done = false;
    Announce(*channel);
  }
}

void RosLockstepWait::Arm(const std::string& text) {
  if (armed_ == text) return;
  armed_ = text;
  armed_at_ = Clock::now();
  for (const auto& channel : channels_) channel->connection.Arm(text);
}

// Then the program of the host counts the messages of the tick, and notes the awaited ones, from the first on: an agent
// may reach it before this process.
bool RosLockstepWait::IsArmed() const {
  return std::all_of(channels_.begin(), channels_.end(),
                     [this](const auto& channel) { return channel->connection.watched().armed == armed_; });
}

bool RosLockstepWait::IsPrepared() {
  const std::lock_guard lock(mutex_);
  awaits_armed_ = !armed_.empty() && SecondsSince(armed_at_) <= kMaxArming && !IsArmed();
  return !awaits_armed_;
}

Result<TickRelease> RosLockstepWait::Release() {
  const std::lock_guard lock(mutex_);
  TickRelease release;
  if (!awaits_answers_) return release;
  const double waited = SecondsSince(published_at_);
  bool is_told = !follow_;
  for (const auto& channel : channels_) {
    is_told = is_told && channel->is_told();
    for (Awaited& awaited : channel->awaited) {
      if (awaited.done || awaited.is_dropped) continue;
      // A node that has never answered is still starting: it is awaited without limit, with one notice.
      if (limit_ > 0.0 && awaited.was_seen && waited > limit_) {
        if (Status end = DropAtLimit(awaited, waited); !end.ok()) return end.error();
        continue;
      }
      release.awaited.push_back(awaited.name);
    }
  }
  if (!is_told && release.awaited.empty()) release.awaited.emplace_back("ROS");
  release.is_released = release.awaited.empty();
  if (release.is_released) {
    awaits_answers_ = false;
    first_wait_is_over_ = true;
    // Early, while there is time: the program of the host then mostly knows the next tick before it is committed.
    Arm(TextOf(edition_, (tick_ / period_ + 1) * period_));
  } else if (is_told && waited > kFirstAnswers && !std::exchange(first_wait_is_over_, true)) {
    reports_.Add(fmt::format("tick {} waits for {}; docs/ros2-lockstep.md", tick_, fmt::join(release.awaited, ", ")));
  }
  return release;
}

Status RosLockstepWait::DropAtLimit(Awaited& awaited, double waited) {
  if (ends_at_limit_) {
    return Failure(
        fmt::format("tick {} has waited {:.1f} s for {} of ROS (--ros-lockstep-limit)", tick_, waited, awaited.name));
  }
  awaited.is_dropped = true;
  awaited.waited_seconds += waited;
  reports_.Add(fmt::format("tick {} continues after {:.1f} s without {}, until that is heard of again", tick_, waited,
                           awaited.name));
  return {};
}

std::vector<SlowRobot> RosLockstepWait::SlowestAwaited() {
  const std::lock_guard lock(mutex_);
  std::vector<SlowRobot> slowest;
  for (const auto& channel : channels_) {
    for (const Awaited& awaited : channel->awaited) {
      slowest.push_back({awaited.name, awaited.times_last, awaited.waited_seconds});
    }
  }
  std::stable_sort(slowest.begin(), slowest.end(),
                   [](const SlowRobot& a, const SlowRobot& b) { return a.waited_seconds > b.waited_seconds; });
  return slowest;
}

void RosLockstepWait::Run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stop_ || follow_; });
    if (stop_) return;
    follow_ = false;
    std::vector<std::unique_ptr<Channel>> unused;
    try {
      unused = Follow(*scene_);
    } catch (const std::exception& exception) {  // of DDS, as without memory
      reports_.Add(exception.what());
    }
    lock.unlock();
    unused.clear();
    control_.Wake();
    lock.lock();
  }
}

void RosLockstepWait::OnArrival() {
  bool wakes = false;
  try {
    const std::lock_guard lock(mutex_);
    wakes = Advance();
  } catch (const std::exception& exception) {  // of DDS, as without memory
    reports_.Add(exception.what());
  }
  if (wakes) control_.Wake();
}

std::vector<std::unique_ptr<RosLockstepWait::Channel>> RosLockstepWait::Follow(const Scene& scene) {
  const auto robots = ros::FindRobotsInRos(scene.world(), options_.network.domain, options_.names);
  std::vector<std::unique_ptr<Channel>> before = std::exchange(channels_, {});
  const auto channel_of = [&](std::uint32_t domain) -> Channel& {
    for (const auto& channel : channels_) {
      if (channel->domain == domain) return *channel;
    }
    // A connection that is still used stays, with its nodes' matched readers: discovery takes seconds.
    const auto kept = std::find_if(before.begin(), before.end(),
                                   [domain](const auto& channel) { return channel && channel->domain == domain; });
    if (kept != before.end()) {
      channels_.push_back(std::move(*kept));
      return *channels_.back();
    }
    std::unique_ptr<ros::HostConnection> own;
    if (domain != options_.network.domain) {
      own = std::make_unique<ros::HostConnection>(options_.network.distribution, options_.socket, domain,
                                                  ros::HostConnection::Sending::kAtOnce);
    }
    if (own) own->WatchTopics([this] { OnArrival(); });
    ros::HostConnection& used = own ? *own : of_run_;
    channels_.push_back(std::make_unique<Channel>(domain, std::move(own), used));
    return *channels_.back();
  };
  std::set<std::pair<std::uint32_t, std::string>> wanted;  // domain and name
  const auto want = [&](std::uint32_t domain, const std::string& name) { wanted.emplace(domain, name); };
  const auto want_of = [&](const auto& robot, const std::string& name) {
    const std::string space = robot.node_namespace == "/" ? "" : robot.node_namespace;
    want(robot.domain, name.starts_with("~/") ? space + name.substr(1) : name);
  };
  for (const RosLockstepName& name : options_.lockstep.names) {
    if (name.robot.empty() && !name.name.starts_with("~/")) want(options_.network.domain, name.name);
    for (const auto& [id, robot] : robots) {
      const bool is_of_robot =
          name.robot.empty() ? name.name.starts_with("~/") : scene.world().robot(id).name == name.robot;
      if (is_of_robot) want_of(robot, name.name);
    }
  }
  for (const auto& [domain, name] : wanted) {
    Channel& channel = channel_of(domain);
    const auto is_same = [&name = name](const Awaited& awaited) { return awaited.name == name; };
    if (std::any_of(channel.awaited.begin(), channel.awaited.end(), is_same)) continue;
    Awaited awaited{.name = name, .is_topic = name.starts_with("/")};
    if (awaited.is_topic) awaited.watch = channel.connection.Watch("rt" + name);
    channel.awaited.push_back(std::move(awaited));
  }
  for (const auto& channel : channels_) {
    std::erase_if(channel->awaited, [&](const Awaited& awaited) {
      if (wanted.contains({channel->domain, awaited.name})) return false;
      if (awaited.is_topic) channel->connection.Unwatch(awaited.watch);
      return true;
    });
    channel->connection.Announce();
    if (!armed_.empty()) channel->connection.Arm(armed_);
    if (awaits_answers_ && channel->announcement == Channel::Announcement::kPending) Announce(*channel);
  }
  std::erase(before, nullptr);
  return before;
}

bool RosLockstepWait::Advance() {
  bool is_complete = awaits_answers_;
  for (const auto& channel : channels_) {
    const ros::HostConnection::Watched watched = channel->connection.watched();
    if (awaits_answers_ && channel->announcement == Channel::Announcement::kGiven && watched.is_told) {
      channel->announcement = Channel::Announcement::kTold;
    }
    for (Awaited& awaited : channel->awaited) {
      if (awaited.is_topic && watched.armed == armed_ && watched.arrived.contains(awaited.watch)) Note(awaited);
    }
    ReadAnswers(*channel);
    is_complete = is_complete && channel->is_told() &&
                  std::all_of(channel->awaited.begin(), channel->awaited.end(),
                              [](const Awaited& awaited) { return awaited.done || awaited.is_dropped; });
  }
  return is_complete || (awaits_armed_ && IsArmed());
}

// Behind all messages of the tick, and so is the time.
void RosLockstepWait::Announce(Channel& channel) {
  channel.announcement = Channel::Announcement::kGiven;
  channel.connection.Collect();
  if (channel.domain == options_.network.domain) hooks_.show_clock(tick_, interval_ns_);
  const std::int64_t ns = static_cast<std::int64_t>(tick_) * interval_ns_;
  ros::Header header{};
  dds::WireArena arena;
  header.stamp = {static_cast<std::int32_t>(ns / kNsPerSecond), static_cast<std::uint32_t>(ns % kNsPerSecond)};
  header.frame_id = arena.Copy("");
  channel.connection.Tell(*channel.ticks, &header, *channel.answers);
}

void RosLockstepWait::ReadAnswers(Channel& channel) {
  const std::int64_t awaited_ns = static_cast<std::int64_t>(tick_) * interval_ns_;
  channel.answers->Drain([&](const void* sample) {
    const auto& answer = *static_cast<const ros::Header*>(sample);
    const std::string name = PlainLine(dds::Text(answer.frame_id), 200);
    const auto found = std::find_if(channel.awaited.begin(), channel.awaited.end(),
                                    [&](const Awaited& awaited) { return !awaited.is_topic && awaited.name == name; });
    if (found == channel.awaited.end()) {
      return reports_.Add(fmt::format("{}: ignored the answer of '{}', for which no tick waits", kDoneTopic, name));
    }
    const std::int64_t ns = std::int64_t{answer.stamp.sec} * kNsPerSecond + answer.stamp.nanosec;
    found->was_seen = true;
    if (std::exchange(found->is_dropped, false)) reports_.Add(fmt::format("ticks wait for {} again", name));
    if (ns == awaited_ns) {
      if (channel.is_told()) Note(*found);  // else to the frame before an edit
      return;
    }
    reports_.Add(fmt::format("{}: ignored the answer of '{}' to {}.{:09} s, which is not the awaited tick", kDoneTopic,
                             name, answer.stamp.sec, answer.stamp.nanosec));
  });
}

void RosLockstepWait::Note(Awaited& awaited) {
  if (std::exchange(awaited.is_dropped, false)) reports_.Add(fmt::format("ticks wait for {} again", awaited.name));
  awaited.was_seen = true;
  if (!awaits_answers_ || std::exchange(awaited.done, true)) return;
  awaited.waited_seconds += SecondsSince(published_at_);
  const bool is_last = std::all_of(channels_.begin(), channels_.end(), [](const auto& channel) {
    return std::all_of(channel->awaited.begin(), channel->awaited.end(),
                       [](const Awaited& other) { return other.done || other.is_dropped; });
  });
  if (is_last) ++awaited.times_last;
}

}  // namespace troupe
