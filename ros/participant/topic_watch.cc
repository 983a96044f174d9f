#include "ros/participant/topic_watch.h"

#include <string_view>
#include <utility>
#include <vector>

#include "ros/connection/dds_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/messages/messages.h"
#include "transport/dds/binding/loaned_samples.h"

namespace troupe::ros {
namespace {

constexpr std::int32_t kDepth = 10;
constexpr std::string_view kClockTopic = "rt/clock";

}  // namespace

// Of one topic, with the type of its first writer.
struct TopicWatch::AnyReader {
  AnyReader(const RosParticipant& participant, const std::string& topic, std::string type, bool reliable,
            std::function<void()> on_message)
      : type_name(std::move(type)), notify(std::move(on_message)) {
    descriptor.m_typename = type_name.c_str();
    topic_entity = dds::Entity(dds::CreateTopic(participant.participant(), descriptor, topic));
    reader = dds::Entity(dds::Check(
        dds_create_reader(
            participant.subscriber().handle(), topic_entity.handle(),
            (dds::Qos() << (reliable ? dds::Reliability::Reliable(0.0) : dds::Reliability::BestEffort())
                        << dds::History::KeepLast(kDepth) << TypeUserData(participant.distribution(), descriptor))
                .get(),
            nullptr),
        "creating a reader of topic '" + topic + "'"));
    listener.on_data_available = [this] { Read(); };
    dds::SetListener(reader.handle(), listener);
    Read();
  }
  ~AnyReader() { reader.close(); }

  void Read() {
    bool arrived = false;
    for (;;) {
      const auto samples = dds::Loan<char>(reader.handle(), dds_take, "taking samples");
      if (samples.empty()) break;
      for (const auto sample : samples) arrived = arrived || sample.info().valid();
    }
    if (arrived) notify();
  }

  const std::string type_name;
  const std::function<void()> notify;
  dds_topic_descriptor_t descriptor = any_type_Message__desc;
  dds::Entity topic_entity;
  dds::DataReaderListener listener;
  dds::Entity reader;
};

TopicWatch::TopicWatch(const RosParticipant& participant, TopicReaders& agents, std::function<void()> wake)
    : participant_(participant), agents_(agents), wake_(std::move(wake)) {
  agents_.Observe([this](const std::string& topic) { Note(topic); });
}

TopicWatch::~TopicWatch() {
  agents_.Observe({});
  publications_.close();
  subscriptions_.close();
  readers_.clear();
}

void TopicWatch::Add(const void* owner, std::uint32_t id, const std::string& topic, Callbacks callbacks) {
  {
    const std::lock_guard lock(mutex_);
    if (round_.arrived.contains(topic)) callbacks.on_arrival(round_.text);
    watches_.emplace(topic, Watch{owner, id, std::move(callbacks)});
  }
  // Others show the endpoints that are known already again.
  listener_.on_data_available = wake_;
  const auto follow = [this](dds::Entity& reader, dds_entity_t builtin_topic) {
    reader.close();
    reader =
        dds::Entity(dds::Check(dds_create_reader(participant_.participant().handle(), builtin_topic, nullptr, nullptr),
                               "creating a reader of discovered endpoints"));
    dds::SetListener(reader.handle(), listener_);
  };
  follow(publications_, DDS_BUILTIN_TOPIC_DCPSPUBLICATION);
  follow(subscriptions_, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION);
  writers_.clear();
  of_clock_.clear();
  Update();
}

void TopicWatch::Remove(const void* owner, std::uint32_t id) {
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(watches_, [&](const auto& watch) { return watch.second.owner == owner && watch.second.id == id; });
  }
  EndUnwatchedReaders();
}

void TopicWatch::RemoveAll(const void* owner) {
  const std::lock_guard lock(mutex_);
  std::erase_if(watches_, [&](const auto& watch) { return watch.second.owner == owner; });
}

void TopicWatch::EndUnwatchedReaders() {
  std::vector<std::string> unused;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [topic, reader] : readers_) {
      if (!watches_.contains(topic)) unused.push_back(topic);
    }
  }
  for (const std::string& topic : unused) readers_.erase(topic);  // without the lock, for which its thread may wait
}

void TopicWatch::Arm(const std::string& text) {
  {
    const std::lock_guard lock(mutex_);
    if (text == round_.text) return;
    std::swap(round_, previous_);
    if (text != round_.text) round_ = {text, {}};
    for (const auto& [topic, watch] : watches_) {
      if (round_.arrived.contains(topic)) watch.callbacks.on_arrival(text);
    }
  }
  EndUnwatchedReaders();
}

void TopicWatch::Update() {
  if (publications_.handle() <= 0) return;
  FollowWriters();
  FollowClockReaders();
  TellTimed();
}

void TopicWatch::FollowWriters() {
  for (;;) {
    const auto samples =
        dds::Loan<dds_builtintopic_endpoint_t>(publications_.handle(), dds_take, "taking discovered writers");
    if (samples.empty()) return;
    for (const auto sample : samples) {
      const dds_instance_handle_t writer = sample.info().instance_handle();
      if (!sample.info().instance_alive()) writers_.erase(writer);
      if (!sample.info().valid()) continue;
      const std::string topic = sample.data().topic_name;
      {
        const std::lock_guard lock(mutex_);
        if (!watches_.contains(topic)) continue;
      }
      if (sample.info().instance_alive()) writers_[writer] = {topic, sample.data().participant_instance_handle};
      if (!readers_.contains(topic)) MakeReader(sample.data());
    }
  }
}

void TopicWatch::MakeReader(const dds_builtintopic_endpoint_t& writer) {
  const std::string topic = writer.topic_name;
  dds_reliability_kind_t kind = DDS_RELIABILITY_BEST_EFFORT;
  dds_duration_t blocking = 0;
  const bool reliable = dds_qget_reliability(writer.qos, &kind, &blocking) && kind == DDS_RELIABILITY_RELIABLE;
  try {
    readers_[topic] = std::make_unique<AnyReader>(participant_, topic, writer.type_name, reliable, [this, topic] {
      // Else the agent has perhaps not been passed it yet.
      if (!agents_.Contain(topic)) Note(topic);
    });
  } catch (const dds::Exception&) {  // another type than that of a topic here: its reader is an agent's
    readers_.erase(topic);
  }
}

void TopicWatch::FollowClockReaders() {
  for (;;) {
    const auto samples =
        dds::Loan<dds_builtintopic_endpoint_t>(subscriptions_.handle(), dds_take, "taking discovered readers");
    if (samples.empty()) return;
    for (const auto sample : samples) {
      const dds_instance_handle_t reader = sample.info().instance_handle();
      if (!sample.info().instance_alive()) {
        of_clock_.erase(reader);
      } else if (sample.info().valid() && std::string_view(sample.data().topic_name) == kClockTopic) {
        of_clock_[reader] = sample.data().participant_instance_handle;
      }
    }
  }
}

void TopicWatch::TellTimed() {
  std::set<dds_instance_handle_t> with_clock;
  for (const auto& [reader, program] : of_clock_) with_clock.insert(program);
  std::set<std::string> timed;
  for (const auto& [handle, writer] : writers_) {
    if (with_clock.contains(writer.program)) timed.insert(writer.topic);
  }
  const std::lock_guard lock(mutex_);
  for (auto& [topic, watch] : watches_) {
    const bool is_timed = timed.contains(topic);
    if (std::exchange(watch.is_timed, is_timed) != is_timed) watch.callbacks.on_timed(is_timed);
  }
}

void TopicWatch::Note(const std::string& topic) {
  const std::lock_guard lock(mutex_);
  if (round_.text.empty() || !round_.arrived.insert(topic).second) return;
  const auto [begin, end] = watches_.equal_range(topic);
  for (auto watch = begin; watch != end; ++watch) watch->second.callbacks.on_arrival(round_.text);
}

}  // namespace troupe::ros
