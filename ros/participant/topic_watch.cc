#include "ros/participant/topic_watch.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "ros/connection/dds_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/messages/messages.h"
#include "transport/dds/binding/loaned_samples.h"

namespace troupe::ros {
namespace {

constexpr std::size_t kBatch = 64;
constexpr std::int32_t kDepth = 10;

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
  readers_.clear();
}

void TopicWatch::Add(const void* owner, std::uint32_t id, const std::string& topic, OnArrival on_arrival) {
  {
    const std::lock_guard lock(mutex_);
    watches_.emplace(topic, Watch{owner, id, std::move(on_arrival), armed_});
  }
  // Another one shows the writers that are known already again.
  publications_.close();
  publications_ = dds::Entity(dds::Check(
      dds_create_reader(participant_.participant().handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
      "creating a reader of discovered writers"));
  listener_.on_data_available = wake_;
  dds::SetListener(publications_.handle(), listener_);
  Update();
}

void TopicWatch::Remove(const void* owner, std::uint32_t id) {
  std::vector<std::string> unused;
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(watches_, [&](const auto& watch) { return watch.second.owner == owner && watch.second.id == id; });
    for (const auto& [topic, reader] : readers_) {
      if (!watches_.contains(topic)) unused.push_back(topic);
    }
  }
  for (const std::string& topic : unused) readers_.erase(topic);
}

void TopicWatch::RemoveAll(const void* owner) {
  std::vector<std::uint32_t> ids;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [topic, watch] : watches_) {
      if (watch.owner == owner) ids.push_back(watch.id);
    }
  }
  for (const std::uint32_t id : ids) Remove(owner, id);
}

void TopicWatch::Arm(const std::string& text) {
  const std::lock_guard lock(mutex_);
  const bool returns = text == previous_;
  if (text != armed_) previous_ = std::exchange(armed_, text);
  for (auto& [topic, watch] : watches_) {
    if (text != watch.text) {
      watch.arrived_before = std::exchange(watch.arrived, returns && watch.arrived_before);
      watch.text = text;
    }
    if (watch.arrived) watch.on_arrival(armed_);
  }
}

void TopicWatch::Update() {
  if (publications_.handle() <= 0) return;
  for (;;) {
    void* samples[kBatch] = {};
    dds_sample_info_t infos[kBatch];
    const dds_return_t count = dds_take(publications_.handle(), samples, infos, kBatch, kBatch);
    if (count <= 0) return;
    for (dds_return_t i = 0; i < count; ++i) {
      if (!infos[i].valid_data) continue;
      const auto& writer = *static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
      const std::string topic = writer.topic_name;
      {
        const std::lock_guard lock(mutex_);
        if (!watches_.contains(topic)) continue;
      }
      if (readers_.contains(topic)) continue;
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
    dds_return_loan(publications_.handle(), samples, count);
  }
}

void TopicWatch::Note(const std::string& topic) {
  const std::lock_guard lock(mutex_);
  if (watches_.empty() || armed_.empty()) return;
  const auto [begin, end] = watches_.equal_range(topic);
  for (auto watch = begin; watch != end; ++watch) {
    if (!std::exchange(watch->second.arrived, true)) watch->second.on_arrival(armed_);
  }
}

}  // namespace troupe::ros
