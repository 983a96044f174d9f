#include "ros/connection/dds_endpoints.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <optional>
#include <random>
#include <utility>

namespace troupe::ros {
namespace {

// Batches of requests whose callers have no reader yet. The oldest ends, because a peer need never make one.
constexpr std::size_t kMaxWaiting = 100;

// 16 random bytes as ROS writes them, "01.0f.10...".
std::string NewServiceId() {
  std::random_device device;
  std::string id;
  for (int i = 0; i < 16; ++i) {
    char byte[4];
    std::snprintf(byte, sizeof byte, "%s%02x", i == 0 ? "" : ".", static_cast<unsigned>(device() & 0xffU));
    id += byte;
  }
  return id;
}

struct Sender {
  dds_guid_t guid;
  dds_instance_handle_t handle;
};

// The participant of a writer that the reader matches; nothing once it has left.
std::optional<Sender> SenderOf(dds_entity_t reader, dds_instance_handle_t publication) {
  dds_builtintopic_endpoint_t* const endpoint = dds_get_matched_publication_data(reader, publication);
  if (endpoint == nullptr) return std::nullopt;
  const Sender participant = {endpoint->participant_key, endpoint->participant_instance_handle};
  dds_builtintopic_free_endpoint(endpoint);
  return participant;
}

// Whether `writer` matches a reader of the participant.
bool HasReaderOf(dds_entity_t writer, const dds_guid_t& participant) {
  std::vector<dds_instance_handle_t> subscriptions(64);
  dds_return_t count = 0;
  for (;;) {
    count = dds_get_matched_subscriptions(writer, subscriptions.data(), subscriptions.size());
    // Cyclone DDS returns the number of all, also of those that had no room.
    if (count <= static_cast<dds_return_t>(subscriptions.size())) break;
    subscriptions.resize(static_cast<std::size_t>(count));
  }
  for (dds_return_t i = 0; i < count; ++i) {
    dds_builtintopic_endpoint_t* const receiver =
        dds_get_matched_subscription_data(writer, subscriptions[static_cast<std::size_t>(i)]);
    if (receiver == nullptr) continue;
    const bool same = std::memcmp(receiver->participant_key.v, participant.v, sizeof participant.v) == 0;
    dds_builtintopic_free_endpoint(receiver);
    if (same) return true;
  }
  return false;
}

constexpr std::size_t kMaxNoted = 1000;  // a peer can make up any number

}  // namespace

DdsTopicWriter::DdsTopicWriter(RosParticipant& owner, const TopicSpec& spec, OnMatched on_matched)
    : owner_(owner),
      on_matched_(std::move(on_matched)),
      topic_(dds::CreateTopic(owner.participant(), *spec.type, spec.topic)),
      writer_(dds::Check(
          dds_create_writer(owner.publisher().handle(), topic_.handle(),
                            (ToDds(spec.qos) << TypeUserData(owner.distribution(), *spec.type)).get(), nullptr),
          "creating a writer of topic '" + spec.topic + "'")) {
  listener_.on_publication_matched = [this](const dds::PublicationMatchedStatus& status) {
    ReactToMatch(status.current_count > 0, status.current_count_change > 0);
  };
  dds::SetListener(writer_.handle(), listener_);
  dds::PublicationMatchedStatus before;
  dds::Check(dds_get_publication_matched_status(writer_.handle(), &before), "reading publication_matched");
  // DDS calls a listener for changes only.
  if (before.current_count > 0) ReactToMatch(true, true);  // matched before the listener was set
}

DdsTopicWriter::~DdsTopicWriter() {
  owner_.RemoveEndpoint(writer_.handle());
  writer_.close();  // before the members that its listener uses
}

void DdsTopicWriter::ReactToMatch(bool wanted, bool is_new) {
  SetWanted(wanted);
  if (wanted) owner_.NoteWanted();
  if (is_new) NoteReader();
  if (on_matched_) on_matched_(wanted, is_new);
}

bool DdsTopicWriter::Write(const void* sample) noexcept {
  return dds_write(writer_.handle(), sample) == DDS_RETCODE_OK;
}

DdsTopicReader::DdsTopicReader(RosParticipant& owner, const TopicSpec& spec, Part part, Notices notices)
    : owner_(owner),
      notices_(std::move(notices)),
      topic_(dds::CreateTopic(owner.participant(), *spec.type, spec.topic)),
      reader_(dds::Check(
          dds_create_reader(owner.subscriber().handle(), topic_.handle(),
                            (ToDds(spec.qos) << TypeUserData(owner.distribution(), *spec.type)).get(), nullptr),
          "creating a reader of topic '" + spec.topic + "'")) {
  listener_.on_data_available = [this] {
    SetArrived();
    if (notices_.on_arrival) notices_.on_arrival();
  };
  const auto miss = [this] {
    SetMissedWriter();
    if (notices_.on_missed_writer) notices_.on_missed_writer();
  };
  if (part == Part::kReliableReader) {
    listener_.on_requested_incompatible_qos = [miss](const auto&) { miss(); };
  }
  if (part == Part::kBestEffortReader) {
    best_effort_writers_.emplace(reader_.handle());
    listener_.on_subscription_matched = [this](const auto& status) {
      best_effort_writers_->Note(status.last_publication_handle);
    };
  }
  dds::SetListener(reader_.handle(), listener_);
  if (part == Part::kReliableReader) {
    dds::RequestedIncompatibleQosStatus before;
    dds::Check(dds_get_requested_incompatible_qos_status(reader_.handle(), &before), "reading incompatible QoS");
    if (before.total_count > 0) miss();
  }
}

DdsTopicReader::~DdsTopicReader() {
  owner_.RemoveEndpoint(reader_.handle());
  reader_.close();  // before the members that its listener uses
}

void DdsTopicReader::ConsumeArrived(const Consume& consume) {
  for (;;) {
    const auto samples = dds::Loan<char>(reader_.handle(), dds_take, "taking samples");
    if (samples.empty()) return;
    for (const auto sample : samples) {
      const bool accepted = !best_effort_writers_ || best_effort_writers_->Contains(sample.info().publication_handle());
      if (sample.info().valid() && accepted) consume(&sample.data());
    }
  }
}

DdsService::DdsService(RosParticipant& owner, const ServiceSpec& spec, OnRequest on_request)
    : owner_(owner),
      on_request_(std::move(on_request)),
      id_(NewServiceId()),
      request_topic_(dds::CreateTopic(owner.participant(), *spec.request, "rq" + spec.name + "Request")),
      response_topic_(dds::CreateTopic(owner.participant(), *spec.response, "rr" + spec.name + "Reply")),
      writer_(dds::Check(
          dds_create_writer(owner.service_publisher().handle(), response_topic_.handle(),
                            (ToDds(spec.qos) << ServiceUserData(owner.distribution(), id_, *spec.response)).get(),
                            nullptr),
          "creating the writer of service '" + spec.name + "'")),
      reader_(dds::Check(
          dds_create_reader(owner.service_subscriber().handle(), request_topic_.handle(),
                            (ToDds(spec.qos) << ServiceUserData(owner.distribution(), id_, *spec.request)).get(),
                            nullptr),
          "creating the reader of service '" + spec.name + "'")) {}

DdsService::~DdsService() {
  owner_.RemoveEndpoint(reader_.handle());
  owner_.RemoveEndpoint(writer_.handle());
  dds::ClearListener(reader_.handle());
  dds::ClearListener(writer_.handle());
}

void DdsService::Start() {
  reader_listener_.on_data_available = [this] { Serve(); };
  dds::SetListener(reader_.handle(), reader_listener_);
  writer_listener_.on_publication_matched = [this](const dds::PublicationMatchedStatus&) { Serve(); };
  dds::SetListener(writer_.handle(), writer_listener_);
  // Requests that came before the listeners.
  Serve();
}

bool DdsService::Respond(const void* response) noexcept {
  return dds_write(writer_.handle(), response) == DDS_RETCODE_OK;
}

// A request may arrive before discovery of its caller's reader; it waits for that, or its response would be lost.
void DdsService::Serve() {
  const std::lock_guard lock(mutex_);
  for (;;) {
    auto samples = dds::Loan<CallHeader>(reader_.handle(), dds_take, "taking requests");
    if (samples.empty()) break;
    std::vector<bool> handled(samples.length(), false);
    waiting_.push_back({std::move(samples), std::move(handled)});
    if (waiting_.size() > kMaxWaiting) waiting_.pop_front();
  }
  for (Batch& batch : waiting_) {
    for (std::size_t i = 0; i < batch.samples.length(); ++i) Deliver(batch, i);
  }
  std::erase_if(waiting_, [](const Batch& batch) {
    return std::find(batch.handled.begin(), batch.handled.end(), false) == batch.handled.end();
  });
}

void DdsService::Deliver(Batch& batch, std::size_t i) {
  if (batch.handled[i]) return;
  const auto sample = batch.samples[i];
  if (sample.info().valid()) {
    const std::optional<Sender> sender = SenderOf(reader_.handle(), sample.info().publication_handle());
    const bool is_foreign = sender && IsOfFastDds(sender->guid);  // without the header: the side on Fast DDS answers it
    // An answer to a caller that has left does no harm.
    if (sender && !is_foreign && !HasReaderOf(writer_.handle(), sender->guid)) return;
    if (!is_foreign) on_request_(&sample.data(), sender ? sender->handle : DDS_HANDLE_NIL);
  }
  batch.handled[i] = true;
}

void BestEffortWriters::Note(dds_instance_handle_t writer) {
  dds_builtintopic_endpoint_t* const endpoint = dds_get_matched_publication_data(reader_, writer);
  if (endpoint == nullptr) return;
  dds_reliability_kind_t kind = DDS_RELIABILITY_RELIABLE;
  dds_duration_t blocking = 0;
  const bool is_known = dds_qget_reliability(endpoint->qos, &kind, &blocking);
  dds_builtintopic_free_endpoint(endpoint);
  if (!is_known || kind != DDS_RELIABILITY_BEST_EFFORT) return;
  const std::lock_guard lock(mutex_);
  if (noted_.size() >= kMaxNoted) noted_.clear();  // Contains asks again for those that are still there
  noted_.insert(writer);
}

bool BestEffortWriters::Contains(dds_instance_handle_t writer) {
  for (const bool asked : {false, true}) {
    if (asked) Note(writer);  // matched before the reader had a listener
    const std::lock_guard lock(mutex_);
    if (noted_.contains(writer)) return true;
  }
  return false;
}

}  // namespace troupe::ros
