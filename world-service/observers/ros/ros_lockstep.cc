#include "world-service/observers/ros/ros_lockstep.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <map>
#include <utility>

#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"
#include "ros/messages/names.h"
#include "ros/messages/tick_answer.h"
#include "transport/dds/binding/wire.h"

namespace troupe {
namespace {

constexpr const char* kTickTopic = "/world/tick";
constexpr const char* kDoneTopic = "/world/tick_done";
constexpr std::int32_t kAnswerDepth = 1000;  // of many nodes
constexpr std::size_t kMaxNameLength = 200;  // bytes, as of a name in a scenario
constexpr std::int64_t kNsPerSecond = 1'000'000'000;

// Wall times, s.
constexpr double kMaxArming = 1.0;                 // of a program that does not answer
constexpr std::chrono::seconds kMaxPreparing(10);  // of one that is being started

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
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
  std::map<std::string, std::uint32_t> watches;  // by topic or node
  bool is_told = false;                          // the nodes of the domain know of the tick: answers count from then on
};

RosLockstepWait::RosLockstepWait(ros::HostConnection& of_run, const ros::RosOptions& options,
                                 std::shared_ptr<const Scene> scene, RunId run, bool has_released,
                                 WorldControl& control, Hooks hooks)
    : of_run_(of_run),
      options_(options),
      run_(run),
      period_(options.lockstep.period.value_or(1)),
      control_(control),
      hooks_(std::move(hooks)),
      reports_(hooks_.report),
      scene_(std::move(scene)),
      answers_({.limit = options.lockstep.limit_seconds.value_or(RosLockstep::kDefaultLimitSeconds),
                .ends_at_limit = options.lockstep.ends_at_limit.value_or(true),
                .were_heard = has_released},
               [this](const std::string& line) { reports_.Add(line); }) {
  of_run_.WatchTopics([this] {
    OnArrival();
    hooks_.on_arrival();
  });
  const std::lock_guard lock(mutex_);
  Follow(*scene_);
  thread_ = std::thread([this] { EndUnused(); });
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

void RosLockstepWait::AwaitPrepared() {
  std::unique_lock lock(mutex_);
  Arm(fmt::format("{:016x}", run_));
  arrived_.wait_for(lock, kMaxPreparing, [this] { return IsArmed(); });
}

void RosLockstepWait::OnWorldChange(std::shared_ptr<const Scene> scene) {
  const std::lock_guard lock(mutex_);
  scene_ = std::move(scene);
  Follow(*scene_);
}

std::string RosLockstepWait::TextOf(Edition edition, Tick tick) const {
  return fmt::format("{:016x} {} {}", run_, edition, tick);
}

std::string_view RosLockstepWait::TickIn(std::string_view text) {
  return text.substr(text.rfind(' ') + 1);
}

// A message counts for a tick from before the agents see its frame on.
void RosLockstepWait::OnCommit(const FrameMessage& frame) {
  const std::lock_guard lock(mutex_);
  answers_.Withdraw();
  if (!frame.paused || !ShowsTick(frame.state.tick)) return;
  Arm(TextOf(frame.edition, frame.state.tick));
  for (const auto& channel : channels_) channel->connection.Show();
}

void RosLockstepWait::OnShown(const FrameMessage& frame) {
  if (!ShowsTick(frame.state.tick)) return;
  const std::lock_guard lock(mutex_);
  edition_ = frame.edition;
  interval_ns_ = scene_->world().interval_ns;
  answers_.Publish(frame.state.tick, Now());
  Arm(TextOf(edition_, frame.state.tick));  // of a run that is continued
  for (const auto& channel : channels_) Announce(*channel);
}

void RosLockstepWait::Arm(const std::string& text) {
  if (armed_ == text) return;
  armed_before_ = std::exchange(armed_, text);
  armed_at_ = Now();
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
  const bool is_prepared = armed_.empty() || Now() - armed_at_ > kMaxArming || IsArmed();
  answers_.SetArming(!is_prepared);
  return is_prepared;
}

Result<TickRelease> RosLockstepWait::Release() {
  const std::lock_guard lock(mutex_);
  TickRelease release;
  if (answers_.stage() != TickAnswers::Stage::kAwaitingAnswers) return release;
  const bool is_announced =
      std::all_of(channels_.begin(), channels_.end(), [](const auto& channel) { return channel->is_told; });
  Result<std::vector<std::string>> awaited = answers_.Awaited(Now());
  if (!awaited.ok()) return awaited.error();
  release.awaited = std::move(awaited).value();
  if (std::exchange(drops_, answers_.drops()) != answers_.drops()) {
    for (const auto& channel : channels_) channel->connection.Await(AwaitedOf(*channel));
  }
  if (!is_announced && release.awaited.empty()) release.awaited.emplace_back("ROS");
  release.is_released = release.awaited.empty();
  if (release.is_released) {
    answers_.Release();
    // Early, while there is time: the program of the host then mostly knows the next tick before it is committed.
    Arm(TextOf(edition_, (answers_.tick() / period_ + 1) * period_));
  }
  return release;
}

std::vector<SlowRobot> RosLockstepWait::SlowestAwaited() {
  const std::lock_guard lock(mutex_);
  return answers_.Slowest();
}

void RosLockstepWait::EndUnused() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stop_ || !unused_.empty(); });
    std::vector<std::unique_ptr<Channel>> ended = std::exchange(unused_, {});
    const bool stops = stop_;
    lock.unlock();
    ended.clear();
    if (stops) return;
    lock.lock();
  }
}

void RosLockstepWait::OnArrival() {
  bool wakes = false;
  try {
    const std::lock_guard lock(mutex_);
    wakes = Advance();
    arrived_.notify_all();
  } catch (const std::exception& exception) {  // of DDS, as without memory
    reports_.Add(exception.what());
  }
  if (wakes) control_.Wake();
}

std::set<TickAnswers::Name> RosLockstepWait::ParticipantsIn(const Scene& scene) const {
  const auto robots = ros::FindRobotsInRos(scene.world(), options_.network.domain, options_.names);
  std::set<TickAnswers::Name> names;
  for (const RosLockstepName& name : options_.lockstep.names) {
    const bool is_below_robot = name.name.starts_with("~/");
    if (name.robot.empty() && !is_below_robot) names.emplace(options_.network.domain, name.name);
    for (const auto& [id, robot] : robots) {
      const bool is_of_robot = name.robot.empty() ? is_below_robot : scene.world().robot(id).name == name.robot;
      if (!is_of_robot) continue;
      const std::string space = robot.node_namespace == "/" ? "" : robot.node_namespace;
      names.emplace(robot.domain, is_below_robot ? space + name.name.substr(1) : name.name);
    }
  }
  return names;
}

RosLockstepWait::Channel& RosLockstepWait::OpenChannel(std::uint32_t domain,
                                                       std::vector<std::unique_ptr<Channel>>& before) {
  const auto is_in_domain = [domain](const auto& channel) { return channel && channel->domain == domain; };
  if (const auto open = std::find_if(channels_.begin(), channels_.end(), is_in_domain); open != channels_.end()) {
    return **open;
  }
  // A connection that is still used stays, with its nodes' matched readers: discovery takes seconds.
  if (const auto kept = std::find_if(before.begin(), before.end(), is_in_domain); kept != before.end()) {
    return *channels_.emplace_back(std::move(*kept));
  }
  std::unique_ptr<ros::HostConnection> own;
  if (domain != options_.network.domain) {
    own = std::make_unique<ros::HostConnection>(options_.network.distribution, options_.socket, domain,
                                                ros::HostConnection::Sending::kAtOnce);
    own->WatchTopics([this] { OnArrival(); });
  }
  ros::HostConnection& used = own ? *own : of_run_;
  return *channels_.emplace_back(std::make_unique<Channel>(domain, std::move(own), used));
}

void RosLockstepWait::Follow(const Scene& scene) {
  std::vector<std::unique_ptr<Channel>> before = std::exchange(channels_, {});
  const std::set<TickAnswers::Name> names = ParticipantsIn(scene);
  for (const TickAnswers::Name& name : names) OpenChannel(name.first, before);
  answers_.SetParticipants(names);
  for (const auto& channel : channels_) {
    WatchParticipants(*channel, names);
    channel->connection.Announce();
    if (!armed_.empty()) channel->connection.Arm(armed_);
  }
  std::erase(before, nullptr);
  for (auto& channel : before) unused_.push_back(std::move(channel));
  if (!unused_.empty()) changed_.notify_one();
}

void RosLockstepWait::WatchParticipants(Channel& channel, const std::set<TickAnswers::Name>& names) {
  std::erase_if(channel.watches, [&](const auto& watch) {
    if (names.contains({channel.domain, watch.first})) return false;
    channel.connection.Unwatch(watch.second);
    return true;
  });
  for (const TickAnswers::Name& name : names) {
    const std::string& watched = name.second;
    if (name.first != channel.domain || channel.watches.contains(watched)) continue;
    channel.watches[watched] = channel.connection.Watch(TickAnswers::IsTopic(name) ? "rt" + watched : watched);
  }
}

bool RosLockstepWait::Advance() {
  const bool awaits = answers_.stage() == TickAnswers::Stage::kAwaitingAnswers;
  bool is_told = true;
  for (const auto& channel : channels_) {
    const ros::HostConnection::Watched watched = channel->connection.watched();
    channel->is_told = channel->is_told || (awaits && watched.is_told);
    is_told = is_told && channel->is_told;
    for (const auto& [watched_name, watch] : channel->watches) {
      const TickAnswers::Name name{channel->domain, watched_name};
      if (!TickAnswers::IsTopic(name)) continue;  // its answers are read below
      answers_.SetReadsClock(name, watched.timed.contains(watch), Now());
      if (watched.armed != armed_) continue;
      if (watched.arrived.contains(watch)) answers_.OnAnswer(name, Now());
      const bool is_before_edit = watched.armed_before == armed_before_ && TickIn(armed_before_) == TickIn(armed_);
      if (is_before_edit && watched.arrived_before.contains(watch)) answers_.OnAnswerBeforeEdit(name, Now());
    }
    ReadAnswers(*channel);
  }
  NoteDelivery();
  NoteCalls();
  if (awaits) return is_told && answers_.are_complete();
  return answers_.stage() == TickAnswers::Stage::kAwaitingArming && IsArmed();
}

void RosLockstepWait::NoteDelivery() {
  TickAnswers::Delivery delivery = TickAnswers::Delivery::kTold;
  std::set<TickAnswers::Name> absent;
  for (const auto& channel : channels_) {
    const std::optional<std::set<std::uint32_t>> held_for = channel->connection.watched().held_for;
    if (channel->is_told) continue;
    if (!held_for) {
      delivery = TickAnswers::Delivery::kUnknown;
      break;
    }
    delivery = TickAnswers::Delivery::kHeld;
    for (const auto& [name, watch] : channel->watches) {
      if (held_for->contains(watch)) absent.emplace(channel->domain, name);
    }
  }
  answers_.SetDelivery(delivery, absent, Now());
}

void RosLockstepWait::NoteCalls() {
  std::set<TickAnswers::Name> calling;
  for (const auto& channel : channels_) {
    const std::set<std::uint32_t> ids = channel->connection.watched().calling;
    for (const auto& [name, watch] : channel->watches) {
      if (ids.contains(watch)) calling.emplace(channel->domain, name);
    }
  }
  answers_.SetCalling(calling, Now());
}

std::set<std::uint32_t> RosLockstepWait::AwaitedOf(const Channel& channel) const {
  std::set<std::uint32_t> awaited;
  for (const auto& [name, watch] : channel.watches) {
    if (answers_.is_awaited({channel.domain, name})) awaited.insert(watch);
  }
  return awaited;
}

// Behind all messages of the tick, and so is the time.
void RosLockstepWait::Announce(Channel& channel) {
  channel.is_told = false;
  channel.connection.Collect();
  const Tick tick = answers_.tick();
  if (channel.domain == options_.network.domain) hooks_.show_clock(tick, interval_ns_);
  const std::int64_t ns = static_cast<std::int64_t>(tick) * interval_ns_;
  ros::Header header{};
  dds::WireArena arena;
  header.stamp = {static_cast<std::int32_t>(ns / kNsPerSecond), static_cast<std::uint32_t>(ns % kNsPerSecond)};
  header.frame_id = arena.Copy(EditionEntry());
  channel.connection.Tell(*channel.ticks, &header, *channel.answers, AwaitedOf(channel));
}

std::string RosLockstepWait::EditionEntry() const {
  return fmt::format("edition:{}", edition_);
}

void RosLockstepWait::ReadAnswers(Channel& channel) {
  const std::int64_t awaited_ns = static_cast<std::int64_t>(answers_.tick()) * interval_ns_;
  channel.answers->Drain([&](const void* sample) {
    const auto& answer = *static_cast<const ros::Header*>(sample);
    const ros::TickAnswer parsed = ros::ParseTickAnswer(dds::Text(answer.frame_id));
    const TickAnswers::Name name{channel.domain, PlainLine(parsed.name, kMaxNameLength)};
    if (TickAnswers::IsTopic(name) || !answers_.Has(name)) {
      return reports_.Add(
          fmt::format("{}: ignored the answer of '{}', for which no tick waits", kDoneTopic, name.second));
    }
    const std::int64_t ns = std::int64_t{answer.stamp.sec} * kNsPerSecond + answer.stamp.nanosec;
    // Before the tick is told it is one to the frame before an edit.
    const bool is_of_edition = parsed.edition.empty() || parsed.edition == EditionEntry();
    const bool counts = channel.is_told && is_of_edition && !parsed.waits;
    if (ns == awaited_ns && counts) return answers_.OnAnswer(name, Now());
    answers_.OnOtherAnswer(name);
    if (ns == awaited_ns) return;
    reports_.Add(fmt::format("{}: ignored the answer of '{}' to {}.{:09} s, which is not the awaited tick", kDoneTopic,
                             name.second, answer.stamp.sec, answer.stamp.nanosec));
  });
}

}  // namespace troupe
