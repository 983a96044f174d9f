#include "ros/participant/topic_watch.h"

#include <algorithm>
#include <utility>

#include "ros/connection/dds_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"
#include "ros/messages/tick_answer.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/loaned_samples.h"
#include "transport/dds/binding/wire.h"

namespace troupe::ros {
namespace {

constexpr std::int32_t kDepth = 10;
constexpr const char* kAnswerTopic = "rt/world/tick_done";
constexpr std::string_view kParameterRequests = "/get_parametersRequest";

// The topic on which a watch hears its messages.
std::string TopicOf(const std::string& watched) {
  return TopicWatch::IsNode(watched) ? kAnswerTopic : watched;
}

}  // namespace

// Of one topic, with the type of its first writer.
struct TopicWatch::AnyReader {
  AnyReader(const RosParticipant& participant, const std::string& topic, std::string type, bool reliable,
            std::function<void(dds_instance_handle_t writer)> on_message)
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
    for (;;) {
      const auto samples = dds::Loan<char>(reader.handle(), dds_take, "taking samples");
      if (samples.empty()) return;
      for (const auto sample : samples) {
        if (sample.info().valid()) notify(sample.info().publication_handle());
      }
    }
  }

  const std::string type_name;
  const std::function<void(dds_instance_handle_t)> notify;
  dds_topic_descriptor_t descriptor = any_type_Message__desc;
  dds::Entity topic_entity;
  dds::DataReaderListener listener;
  dds::Entity reader;
};

// Of the answers of nodes.
struct TopicWatch::AnswerReader {
  AnswerReader(const RosParticipant& participant,
               std::function<void(const Header& answer, dds_instance_handle_t writer)> on_answer)
      : notify(std::move(on_answer)),
        topic(participant.participant(), kAnswerTopic),
        reader(participant.subscriber(), topic,
               ToDds(Stream(kAnswerDepth)) << TypeUserData<Header>(participant.distribution())) {
    dds::DataReaderListener listener;
    listener.on_data_available = [this] { Read(); };
    reader.set_listener(std::move(listener));
    Read();
  }

  void Read() {
    for (;;) {
      const auto samples = reader.take();
      if (samples.empty()) return;
      for (const auto sample : samples) {
        if (sample.info().valid()) notify(sample.data(), sample.info().publication_handle());
      }
    }
  }

  static constexpr std::int32_t kAnswerDepth = 1000;  // of many nodes
  const std::function<void(const Header&, dds_instance_handle_t)> notify;
  dds::Topic<Header> topic;
  dds::DataReader<Header> reader;
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
  answers_.reset();
}

void TopicWatch::Add(const void* owner, std::uint32_t id, const std::string& watched, Callbacks callbacks) {
  {
    const std::lock_guard lock(mutex_);
    if (round_.arrived.contains(watched)) {
      callbacks.on_arrival(round_.text);
      heard_.try_emplace(watched, DDS_HANDLE_NIL);
    }
    watches_.emplace(watched, Watch{owner, id, std::move(callbacks)});
  }
  if (IsNode(watched) && !answers_) {
    answers_ = std::make_unique<AnswerReader>(
        participant_, [this](const Header& answer, dds_instance_handle_t writer) { NoteAnswer(answer, writer); });
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
  const std::map<dds_instance_handle_t, Writer> before = std::exchange(writers_, {});
  of_domain_.clear();
  parameter_services_.clear();
  Update();
  for (const auto& [handle, writer] : before) {
    if (!writers_.contains(handle)) Forget(writer, handle);
  }
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
    if (text != round_.text) {
      std::swap(round_, previous_);
      if (text != round_.text) round_ = {text, {}};
    }
    // Also for the same text: the successor of a process that has died arms it again.
    for (const auto& [topic, watch] : watches_) {
      if (round_.arrived.contains(topic)) watch.callbacks.on_arrival(text);
    }
  }
  EndUnwatchedReaders();
}

void TopicWatch::Announce(const Announced& announced) {
  const std::lock_guard lock(mutex_);
  round_.announced = announced;
}

void TopicWatch::Update() {
  if (publications_.handle() <= 0) return;
  FollowWriters();
  FollowReaders();
  TellTimed();
}

bool TopicWatch::IsWatched(const std::string& topic) {
  const std::lock_guard lock(mutex_);
  return std::any_of(watches_.begin(), watches_.end(),
                     [&topic](const auto& watch) { return TopicOf(watch.first) == topic; });
}

// What its program has written is no sign any more that one is there.
void TopicWatch::Forget(const Writer& ended, dds_instance_handle_t handle) {
  const bool has_other = std::any_of(writers_.begin(), writers_.end(),
                                     [&ended](const auto& writer) { return writer.second.topic == ended.topic; });
  const std::lock_guard lock(mutex_);
  std::erase_if(heard_, [&](const auto& heard) {
    const bool is_last_of_topic = heard.second == DDS_HANDLE_NIL && heard.first == ended.topic && !has_other;
    return heard.second == handle || is_last_of_topic;
  });
}

bool TopicWatch::is_unknown(dds_instance_handle_t writer) const {
  return std::none_of(heard_.begin(), heard_.end(), [writer](const auto& heard) { return heard.second == writer; });
}

std::size_t TopicWatch::unknown_writers() const {
  return static_cast<std::size_t>(std::count_if(writers_.begin(), writers_.end(), [this](const auto& writer) {
    return writer.second.topic == kAnswerTopic && is_unknown(writer.first);
  }));
}

bool TopicWatch::has_unknown_node() {
  const std::lock_guard lock(mutex_);
  return unknown_writers() > 0;
}

bool TopicWatch::is_all_heard() {
  const std::lock_guard lock(mutex_);
  return std::all_of(watches_.begin(), watches_.end(),
                     [this](const auto& watch) { return heard_.contains(watch.first); });
}

// Which of the unknown writers will answer under which name shows its first answer: as many nodes are present as there
// are such writers.
std::vector<TopicWatch::Unheard> TopicWatch::FindUnheard() {
  const std::lock_guard lock(mutex_);
  std::vector<Unheard> unheard;
  std::set<std::string> nodes;
  const std::size_t writers = unknown_writers();
  for (const auto& [watched, watch] : watches_) {
    if (heard_.contains(watched)) continue;
    Unheard& added = unheard.emplace_back(Unheard{watch.owner, watch.id, IsNode(watched), false, {}});
    if (added.is_node) {
      nodes.insert(watched);
      added.is_present = nodes.size() <= writers;
    }
    for (const auto& [handle, writer] : writers_) {
      const bool may_write =
          added.is_node ? writer.topic == kAnswerTopic && is_unknown(handle) : writer.topic == watched;
      if (may_write) added.programs.insert(writer.program);
    }
    if (!added.is_node) added.is_present = !added.programs.empty();
  }
  return unheard;
}

std::set<std::string> TopicWatch::FindRead(const std::set<dds_instance_handle_t>& programs, Time since) const {
  std::set<std::string> topics;
  for (const auto& [handle, reader] : of_domain_) {
    if (reader.came_at > since || programs.contains(reader.program)) topics.insert(reader.topic);
  }
  return topics;
}

std::set<std::string> TopicWatch::FindMissing(const void* owner, const std::set<std::uint32_t>& ids) {
  const std::lock_guard lock(mutex_);
  std::set<std::string> missing;
  for (const auto& [watched, watch] : watches_) {
    const bool is_meant = owner == nullptr || (watch.owner == owner && ids.contains(watch.id));
    if (is_meant && !round_.arrived.contains(watched)) missing.insert(watched);
  }
  return missing;
}

std::set<std::string> TopicWatch::FindWaiting() {
  const std::lock_guard lock(mutex_);
  return round_.waiting;
}

bool TopicWatch::IsHeard(const std::string& watched) {
  const std::lock_guard lock(mutex_);
  return heard_.contains(watched);
}

std::set<std::uint32_t> TopicWatch::IdsOf(const void* owner, const std::set<std::string>& watched) {
  const std::lock_guard lock(mutex_);
  std::set<std::uint32_t> ids;
  for (const auto& [name, watch] : watches_) {
    if (watch.owner == owner && watched.contains(name)) ids.insert(watch.id);
  }
  return ids;
}

std::set<std::string> TopicWatch::WatchedOf(dds_instance_handle_t program, bool& may_be_node) {
  const std::lock_guard lock(mutex_);
  std::set<std::string> watched;
  may_be_node = false;
  for (const auto& [handle, writer] : writers_) {
    if (writer.program != program) continue;
    if (writer.topic != kAnswerTopic) {
      watched.insert(writer.topic);
      continue;
    }
    const std::size_t before = watched.size();
    for (const auto& [name, of_name] : heard_) {
      if (of_name == handle) watched.insert(name);
    }
    may_be_node = may_be_node || watched.size() == before;
  }
  return watched;
}

std::vector<std::string> TopicWatch::ParameterServicesOf(dds_instance_handle_t program) const {
  std::vector<std::string> names;
  for (const auto& [reader, service] : parameter_services_) {
    if (service.program == program) names.push_back(service.name);
  }
  return names;
}

void TopicWatch::FollowWriters() {
  for (;;) {
    const auto samples =
        dds::Loan<dds_builtintopic_endpoint_t>(publications_.handle(), dds_take, "taking discovered writers");
    if (samples.empty()) return;
    for (const auto sample : samples) {
      changed_at_ = std::chrono::steady_clock::now();
      const dds_instance_handle_t writer = sample.info().instance_handle();
      if (!sample.info().instance_alive()) {
        if (const auto ended = writers_.extract(writer)) Forget(ended.mapped(), writer);
      }
      if (!sample.info().valid()) continue;
      const std::string topic = sample.data().topic_name;
      if (!IsWatched(topic)) continue;
      if (sample.info().instance_alive()) writers_[writer] = {topic, sample.data().participant_instance_handle};
      if (topic != kAnswerTopic && !readers_.contains(topic)) MakeReader(sample.data());
    }
  }
}

void TopicWatch::MakeReader(const dds_builtintopic_endpoint_t& writer) {
  const std::string topic = writer.topic_name;
  dds_reliability_kind_t kind = DDS_RELIABILITY_BEST_EFFORT;
  dds_duration_t blocking = 0;
  const bool reliable = dds_qget_reliability(writer.qos, &kind, &blocking) && kind == DDS_RELIABILITY_RELIABLE;
  try {
    readers_[topic] =
        std::make_unique<AnyReader>(participant_, topic, writer.type_name, reliable, [this, topic](auto of_message) {
          NoteWriter(topic, of_message);
          // Else the agent has perhaps not been passed it yet.
          if (!agents_.Contain(topic)) Note(topic);
        });
  } catch (const dds::Exception&) {  // another type than that of a topic here: its reader is an agent's
    readers_.erase(topic);
  }
}

void TopicWatch::FollowReaders() {
  for (;;) {
    const auto samples =
        dds::Loan<dds_builtintopic_endpoint_t>(subscriptions_.handle(), dds_take, "taking discovered readers");
    if (samples.empty()) return;
    for (const auto sample : samples) {
      changed_at_ = std::chrono::steady_clock::now();
      const dds_instance_handle_t reader = sample.info().instance_handle();
      if (!sample.info().instance_alive()) {
        of_domain_.erase(reader);
        parameter_services_.erase(reader);
        continue;
      }
      if (!sample.info().valid()) continue;
      const std::string_view topic = sample.data().topic_name;
      const dds_instance_handle_t program = sample.data().participant_instance_handle;
      if (topic.starts_with("rt/")) of_domain_[reader] = {std::string(topic), program, changed_at_};
      if (topic.starts_with("rq/") && topic.ends_with(kParameterRequests) &&
          IsOfCyclone(sample.data().participant_key)) {
        constexpr std::size_t kBegin = 2;  // of "rq/driver/get_parametersRequest"
        constexpr std::size_t kEnd = std::string_view("Request").size();
        parameter_services_[reader] = {std::string(topic.substr(kBegin, topic.size() - kBegin - kEnd)), program};
      }
    }
  }
}

void TopicWatch::TellTimed() {
  std::set<dds_instance_handle_t> with_clock;
  for (const auto& [handle, reader] : of_domain_) {
    if (reader.topic == kClockTopic) with_clock.insert(reader.program);
  }
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

void TopicWatch::NoteWriter(const std::string& watched, dds_instance_handle_t writer) {
  const std::lock_guard lock(mutex_);
  heard_[watched] = writer;  // also if the topic has lost its watches with the process that had them
}

void TopicWatch::Note(const std::string& watched) {
  const std::lock_guard lock(mutex_);
  NoteArrival(watched);
}

void TopicWatch::NoteArrival(const std::string& watched) {
  const auto [begin, end] = watches_.equal_range(watched);
  if (begin != end) heard_.try_emplace(watched, DDS_HANDLE_NIL);
  if (round_.text.empty() || !round_.arrived.insert(watched).second) return;
  for (auto watch = begin; watch != end; ++watch) watch->second.callbacks.on_arrival(round_.text);
  if (wakes_on_arrival_.load()) wake_();
}

// An answer to another tick, or to the announcement before an edit, is a sign of its node and no more.
void TopicWatch::NoteAnswer(const Header& header, dds_instance_handle_t writer) {
  const TickAnswer answer = ParseTickAnswer(dds::Text(header.frame_id));
  const std::lock_guard lock(mutex_);
  if (!IsNode(answer.name) || !watches_.contains(answer.name)) return;  // any text
  heard_[answer.name] = writer;
  const std::optional<Announced>& announced = round_.announced;
  const bool is_to_tick = announced && header.stamp.sec == announced->seconds &&
                          header.stamp.nanosec == announced->nanoseconds &&
                          (answer.edition.empty() || answer.edition == announced->edition);
  if (!is_to_tick) return;
  if (!answer.waits) return NoteArrival(answer.name);
  round_.waiting.insert(answer.name);
  if (wakes_on_arrival_.load()) wake_();
}

}  // namespace troupe::ros
