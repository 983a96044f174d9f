#include "ros/participant/tick_gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <string_view>

#include "ros/connection/topic_types.h"
#include "ros/participant/agent_endpoints.h"

namespace troupe::ros {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr auto kPoll = milliseconds(20);  // of probes
// Without a change of endpoints: DDS delivers what it has discovered within milliseconds; a node that answers no probe
// may still make readers.
constexpr auto kQuiet = milliseconds(200);
constexpr auto kQuietWithoutProbe = seconds(1);
constexpr auto kMaxProbe = seconds(5);
constexpr auto kMaxSettle = seconds(10);  // where tools come and go all the time
// Of nodes that share a writer of answers: fewer writers than names are there.
constexpr auto kQuietWithFewWriters = seconds(5);
constexpr auto kMaxShow = seconds(10);                   // of an agent that does not answer
constexpr auto kShowAgain = seconds(2);                  // the first time, for a node that has answered no probe
constexpr std::size_t kMaxHeld = std::size_t{64} << 20;  // bytes

// "/scan" for "rt/scan"; empty for what nodes wait for in no case.
std::string TopicToTell(const std::string& on_dds) {
  if (!on_dds.starts_with("rt/")) return {};
  std::string topic = on_dds.substr(2);
  if (topic == "/clock" || topic == "/rosout" || topic == "/parameter_events") topic.clear();
  return topic;
}

// CDR: four bytes, then the time of the header in the byte order of this host, which has written it.
std::optional<std::int64_t> StampOf(std::span<const std::byte> bytes, const dds_topic_descriptor_t& type) {
  constexpr std::size_t kTimeAt = 4;
  std::int32_t whole = 0;
  std::uint32_t nanoseconds = 0;
  if (!BeginsWithHeader(type) || bytes.size() < kTimeAt + sizeof whole + sizeof nanoseconds) return std::nullopt;
  std::memcpy(&whole, bytes.data() + kTimeAt, sizeof whole);
  std::memcpy(&nanoseconds, bytes.data() + kTimeAt + sizeof whole, sizeof nanoseconds);
  return std::int64_t{whole} * 1'000'000'000 + nanoseconds;
}

// Transforms have the times of their headers.
bool HasTime(std::span<const std::byte> bytes, const dds_topic_descriptor_t& type) {
  return StampOf(bytes, type) || std::string_view(type.m_typename) == "tf2_msgs::msg::dds_::TFMessage_";
}

// The run and the edition in a text, without the tick: after an edit the messages of the tick before are shown again.
std::string_view SeriesOf(std::string_view text) {
  return text.substr(0, text.rfind(' '));
}

std::size_t HashOf(const std::string& topic, std::span<const std::byte> bytes) {
  constexpr std::size_t kOdd = 0x9E3779B97F4A7C15U;  // the hash of a topic is not that of equal bytes
  return std::hash<std::string_view>()({reinterpret_cast<const char*>(bytes.data()), bytes.size()}) +
         kOdd * std::hash<std::string>()(topic);
}

}  // namespace

bool TickGate::Arm(const std::string& text) {
  if (text == round_.text) return false;
  std::swap(round_, previous_);
  if (text != round_.text) round_ = {.text = text};
  follows_ = SeriesOf(previous_.text) == SeriesOf(text);
  held_bytes_ = 0;
  for (const Held& held : round_.held) held_bytes_ += held.bytes.size();
  told_.reset();
  is_shown_ = false;
  asked_.clear();
  asked_at_ = Clock::now();
  present_at_ = show_again_at_ = Time::max();
  is_closed_ = !watch_.is_all_heard();
  if (!is_closed_) probes_.clear();
  return true;
}

void TickGate::Write(AgentEndpoints& agent, std::uint32_t id, const ReusableWriter& writer,
                     std::span<const std::byte> bytes, bool is_again) {
  if (is_again && !asked_.contains(&agent)) return;
  const std::optional<std::int64_t> stamp = StampOf(bytes, writer.type());
  const std::size_t hash = HashOf(writer.topic(), bytes);
  // An agent that is started again when its tick was released shows it when the next one is armed.
  const bool has_time = HasTime(bytes, writer.type());
  const bool is_of_tick_before = has_time && follows_ && previous_.seen.contains(hash);
  const bool is_new = round_.seen.insert(hash).second && !is_of_tick_before;
  const bool is_for_late_readers = is_again && !is_closed_ && !is_new;
  if (is_for_late_readers && !late_topics_.contains(writer.topic())) return;
  if (!is_for_late_readers) {
    // The time is repeated in any wait.
    if (!is_new && (has_time || is_again || (is_closed_ && writer.topic() == kClockTopic))) return;
    Count& count = round_.counts[writer.topic()];
    ++count.messages;
    count.stamp = stamp;
  }
  if (!is_closed_ || !writer.is_volatile()) return agent.WriteSample(id, bytes);
  round_.held.push_back({&agent, id, {bytes.begin(), bytes.end()}, writer.topic(), hash});
  held_bytes_ += bytes.size();
  if (held_bytes_ > kMaxHeld) Open();
}

void TickGate::Tell(AgentEndpoints& agent, const Announcement& announcement, std::set<std::uint32_t> awaited) {
  ++tells_;
  told_ = Told{&agent, announcement, std::move(awaited)};
  Update();
}

void TickGate::Await(const AgentEndpoints& agent, const std::set<std::uint32_t>& awaited) {
  if (!told_ || told_->agent != &agent) return;
  told_->awaited = awaited;
  Update();
}

void TickGate::OnShown(AgentEndpoints& agent) {
  if (asked_.erase(&agent) > 0) Update();
}

void TickGate::Remove(AgentEndpoints& agent) {
  // Its successor shows again what nodes have not been sent.
  for (Round* const round : {&round_, &previous_}) {
    std::erase_if(round->held, [&agent, round](const Held& held) {
      if (held.agent != &agent) return false;
      round->seen.erase(held.hash);
      --round->counts[held.topic].messages;
      return true;
    });
  }
  if (told_ && told_->agent == &agent) told_.reset();
  if (agent.tells()) tells_ = 0;
  asked_.erase(&agent);
  UpdateBy(Clock::now());
}

void TickGate::NoteReader() {
  reader_at_.store(Clock::now().time_since_epoch().count(), std::memory_order_relaxed);
}

TickGate::Time TickGate::ChangedAt() const {
  return std::max(watch_.changed_at(), Time(Clock::duration(reader_at_.load(std::memory_order_relaxed))));
}

std::vector<TopicWatch::Unheard> TickGate::FindAwaited() const {
  if (watch_.is_all_heard()) return {};
  std::vector<TopicWatch::Unheard> unheard = watch_.FindUnheard();
  std::erase_if(unheard, [this](const TopicWatch::Unheard& watch) {
    return watch.owner != told_->agent || !told_->awaited.contains(watch.id);
  });
  return unheard;
}

void TickGate::Update() {
  due_.reset();
  const Time now = Clock::now();
  UpdateTick(now);
  UpdateCalls();
}

// A node may call once it has one message of the tick: before the tick is told, while it is not known yet which
// participants it waits for.
void TickGate::UpdateCalls() {
  const bool has_calls = !calls_.IsEmpty();
  watch_.WakeOnArrival(has_calls);  // before it is asked what has arrived
  if (!has_calls) return;           // nearly always: what is missing need not be found
  watch_.Update();                  // the writers of a caller are known before its call
  HeldCalls::Tick tick{.missing = {}, .waiting = watch_.FindWaiting(), .is_told = told_ && told_->is_written};
  if (tick.is_told) {
    tick.missing = watch_.FindMissing(told_->agent, told_->awaited);
  } else if (is_shown_ && !is_closed_) {
    tick.missing = watch_.FindMissing(nullptr, {});
  }
  const std::set<std::string> calling = calls_.Update(tick);
  if (!tick.is_told) return;
  const std::set<std::uint32_t> ids = watch_.IdsOf(told_->agent, calling);
  if (std::exchange(told_->calling, ids) != ids) told_->agent->SendCalling(ids);
}

void TickGate::UpdateTick(Time now) {
  if (!told_) return;
  if (!asked_.empty() && now - asked_at_ < kMaxShow) return UpdateBy(asked_at_ + kMaxShow);
  const bool has_asked = present_at_ <= asked_at_;
  if (!is_closed_ || has_asked) Open();
  const std::vector<TopicWatch::Unheard> unheard = FindAwaited();
  if (unheard.empty()) return Open();
  if (!is_closed_) return ShowToLateReaders(unheard, now);
  if (!ArePresent(unheard, now)) return;
  if (present_at_ == Time::max()) present_at_ = now;
  if (IsSettled(unheard, now)) Ask(now);
}

bool TickGate::ArePresent(const std::vector<TopicWatch::Unheard>& unheard, Time now) {
  std::set<std::uint32_t> absent;
  bool lacks_topic = false;
  for (const TopicWatch::Unheard& watch : unheard) {
    if (watch.is_present) continue;
    absent.insert(watch.id);
    lacks_topic = lacks_topic || !watch.is_node;
  }
  if (told_->absent != absent) {
    told_->absent = absent;
    told_->agent->SendHeld(absent);
  }
  if (absent.empty()) return true;
  present_at_ = Time::max();
  if (lacks_topic || !watch_.has_unknown_node()) return false;
  const Time quiet_at = ChangedAt() + kQuietWithFewWriters;
  if (now < quiet_at) UpdateBy(quiet_at);
  return now >= quiet_at;
}

NodeProbe* TickGate::FindProbe(dds_instance_handle_t program, const std::string& service) {
  const auto [found, is_new] = probes_.try_emplace({program, service});
  if (is_new) {
    try {
      found->second = std::make_unique<NodeProbe>(participant_, service);
    } catch (const dds::Exception&) {
    }
  }
  return found->second.get();
}

bool TickGate::HasProbed(const std::vector<TopicWatch::Unheard>& unheard, Time now) {
  bool has_answers = true;
  is_probed_ = true;
  probed_at_ = {};
  for (const TopicWatch::Unheard& watch : unheard) {
    is_probed_ = is_probed_ && !watch.is_node;
    if (watch.is_node) continue;
    for (const dds_instance_handle_t program : watch.programs) {
      const std::vector<std::string> services = watch_.ParameterServicesOf(program);
      is_probed_ = is_probed_ && !services.empty();
      for (const std::string& service : services) {
        NodeProbe* const probe = FindProbe(program, service);
        is_probed_ = is_probed_ && probe != nullptr;
        if (probe == nullptr) continue;
        const std::optional<Time> answered_at = probe->Poll(now);
        has_answers = has_answers && answered_at;
        probed_at_ = std::max(probed_at_, answered_at.value_or(Time()));
      }
    }
  }
  is_probed_ = is_probed_ && has_answers;
  return has_answers;
}

bool TickGate::IsSettled(const std::vector<TopicWatch::Unheard>& unheard, Time now) {
  if (!HasProbed(unheard, now) && now - present_at_ < kMaxProbe) {
    UpdateBy(now + kPoll);
    return false;
  }
  const auto quiet = is_probed_ ? Clock::duration(kQuiet) : Clock::duration(kQuietWithoutProbe);
  const Time quiet_at = std::min(ChangedAt() + quiet, present_at_ + kMaxSettle);
  if (now < quiet_at) UpdateBy(quiet_at);
  return now >= quiet_at;
}

// The tick was told, and waits for a node that has not been heard of, or whose program before has ended. One that
// answers a probe only now may have missed the messages.
void TickGate::ShowToLateReaders(const std::vector<TopicWatch::Unheard>& unheard, Time now) {
  const Time reader_at(Clock::duration(reader_at_.load(std::memory_order_relaxed)));
  if (!HasProbed(unheard, now) && now - std::max(asked_at_, ChangedAt()) < kMaxProbe) return UpdateBy(now + kPoll);
  if (std::max(reader_at, probed_at_) > asked_at_) {
    const Time quiet_at = ChangedAt() + kQuiet;
    if (now >= quiet_at) return AskForLate(unheard, now);
    return UpdateBy(quiet_at);
  }
  const bool is_starting =
      std::any_of(unheard.begin(), unheard.end(), [](const TopicWatch::Unheard& watch) { return watch.is_present; });
  if (is_probed_ || !is_starting) return;
  if (show_again_at_ == Time::max()) {
    show_again_after_ = kShowAgain;
    show_again_at_ = now + show_again_after_;
  }
  if (now >= show_again_at_) {
    show_again_after_ *= 2;
    show_again_at_ = now + show_again_after_;
    AskForLate(unheard, now);
  }
  UpdateBy(show_again_at_);
}

// Other topics stay as they are: their readers may count what they receive.
void TickGate::AskForLate(const std::vector<TopicWatch::Unheard>& unheard, Time now) {
  std::set<dds_instance_handle_t> programs;
  for (const TopicWatch::Unheard& watch : unheard) programs.insert(watch.programs.begin(), watch.programs.end());
  late_topics_ = watch_.FindRead(programs, asked_at_);
  Ask(now);
}

void TickGate::Ask(Time now) {
  asked_at_ = now;
  asked_ = told_->agent->AskToShow();
  if (!asked_.empty()) return UpdateBy(now + kMaxShow);
  Open();
}

void TickGate::Open() {
  is_closed_ = false;
  held_bytes_ = 0;
  for (const Held& held : std::exchange(round_.held, {})) held.agent->WriteSample(held.writer, held.bytes);
  if (!told_ || std::exchange(told_->is_written, true)) return;
  watch_.Announce(told_->announcement.tick);
  told_->agent->Announce(told_->announcement, ListOfTopics(), std::exchange(tells_, 0));
}

std::string TickGate::ListOfTopics() const {
  const TopicWatch::Announced& tick = told_->announcement.tick;
  std::string list = tick.edition;
  const std::int64_t time = std::int64_t{tick.seconds} * 1'000'000'000 + tick.nanoseconds;
  std::string stamps;
  for (const auto& [on_dds, count] : round_.counts) {
    const std::string topic = TopicToTell(on_dds);
    if (topic.empty() || count.messages == 0) continue;
    list += fmt::format(" {}:{}", topic, count.messages);
    if (count.stamp && *count.stamp != time) stamps += fmt::format(" @{}:{}", topic, *count.stamp);
  }
  return list + stamps;
}

}  // namespace troupe::ros
