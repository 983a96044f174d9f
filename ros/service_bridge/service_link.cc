#include "ros/service_bridge/service_link.h"

#include <algorithm>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <memory>
#include <stdexcept>

#include "ros/connection/type_hash.h"
#include "ros/service_bridge/fast_guid.h"
#include "ros/service_bridge/raw_type.h"

namespace troupe::ros {
namespace {

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::types::ReturnCode_t;

constexpr int kReaders = 0;  // indices of ServiceLink::matched_
constexpr int kWriters = 1;

// Samples of an endpoint: requests of clients that are still to be read, responses that a slow client may still get.
constexpr std::int32_t kMostSamples = 1000;
// s. A packet that is lost is sent again after this time, not after the usual 3 s.
constexpr std::uint32_t kHeartbeatNanoseconds = 100'000'000;

std::int64_t ToNumber(const rtps::SequenceNumber_t& number) {
  return std::int64_t{number.high} * (std::int64_t{1} << 32) + number.low;
}

rtps::SequenceNumber_t FromNumber(std::int64_t number) {
  return {static_cast<std::int32_t>(number >> 32), static_cast<std::uint32_t>(number)};
}

std::vector<rtps::octet> Octets(const std::string& text) {
  return {text.begin(), text.end()};
}

// The QoS of services in ROS, but that no request is lost in a burst. Samples have any size, so none is reserved.
template <typename Qos>
void SetServiceQos(Qos& qos, const std::string& user_data) {
  qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = fast::VOLATILE_DURABILITY_QOS;
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  qos.resource_limits().max_samples = kMostSamples;
  qos.resource_limits().max_instances = 1;
  qos.resource_limits().max_samples_per_instance = kMostSamples;
  qos.resource_limits().allocated_samples = 1;
  qos.data_sharing().off();
  qos.user_data().setValue(Octets(user_data));
}

fast::DataReaderQos ReaderQos(const std::string& user_data) {
  fast::DataReaderQos qos;
  SetServiceQos(qos, user_data);
  qos.history().kind = fast::KEEP_ALL_HISTORY_QOS;
  return qos;
}

// Keeps the last samples only, so that a reader that hangs does not make a write wait.
fast::DataWriterQos WriterQos(const std::string& user_data) {
  fast::DataWriterQos qos;
  SetServiceQos(qos, user_data);
  qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = kMostSamples;
  qos.reliable_writer_qos().times.heartbeatPeriod = {0, kHeartbeatNanoseconds};
  return qos;
}

}  // namespace

class ServiceLink::ReaderEvents final : public fast::DataReaderListener {
 public:
  // Null: the matches are not counted.
  ReaderEvents(ServiceLink& link, int* matched) : link_(link), matched_(matched) {}
  void on_data_available(fast::DataReader*) override { link_.ports_.inbox->Notify(link_.part_); }
  void on_subscription_matched(fast::DataReader*, const fast::SubscriptionMatchedStatus& status) override {
    if (matched_ == nullptr) return;
    {
      const std::lock_guard lock(link_.mutex_);
      *matched_ = status.current_count;
    }
    link_.ports_.inbox->Notify(link_.part_);
  }

 private:
  ServiceLink& link_;
  int* matched_;
};

class ServiceLink::WriterEvents final : public fast::DataWriterListener {
 public:
  // Null: notes the readers of clients.
  WriterEvents(ServiceLink& link, int* matched) : link_(link), matched_(matched) {}
  void on_publication_matched(fast::DataWriter*, const fast::PublicationMatchedStatus& status) override {
    {
      const std::lock_guard lock(link_.mutex_);
      if (matched_ != nullptr) {
        *matched_ = status.current_count;
      } else {
        NoteReader(status);
      }
    }
    link_.ports_.inbox->Notify(link_.part_);
  }

 private:
  void NoteReader(const fast::PublicationMatchedStatus& status) {
    const Guid reader = ToGuid(rtps::iHandle2GUID(status.last_subscription_handle));
    if (status.current_count_change > 0) {
      link_.client_readers_.insert(reader);
    } else if (link_.client_readers_.erase(reader) > 0) {
      link_.departed_readers_.push_back(reader);
    }
  }

  ServiceLink& link_;
  int* matched_;
};

ServiceLink::ServiceLink(const LinkPorts& ports, const BridgedService& service)
    : ports_(ports), part_(ports.inbox->NewPart()) {
  request_events_ = std::make_unique<ReaderEvents>(*this, nullptr);
  response_events_ = std::make_unique<ReaderEvents>(*this, &matched_[kWriters]);
  to_service_events_ = std::make_unique<WriterEvents>(*this, &matched_[kReaders]);
  to_clients_events_ = std::make_unique<WriterEvents>(*this, nullptr);
  try {
    MakeEndpoints(service);
  } catch (...) {
    DeleteEndpoints();
    throw;
  }
}

ServiceLink::~ServiceLink() {
  DeleteEndpoints();
}

void ServiceLink::MakeTopics(const LinkPort& port, const BridgedService& service, Topics& topics) {
  const auto make = [&port](const ServiceEndpoint& endpoint) {
    if (port.participant->find_type(endpoint.type).empty()) {
      fast::TypeSupport(new RawType(endpoint.type)).register_type(port.participant);
    }
    fast::Topic* const topic = port.participant->create_topic(endpoint.topic, endpoint.type, fast::TOPIC_QOS_DEFAULT);
    if (topic == nullptr) throw std::runtime_error("cannot bridge the topic " + endpoint.topic);
    return topic;
  };
  topics.requests = make(service.request);
  topics.responses = make(service.response);
}

void ServiceLink::DeleteTopics(const LinkPort& port, const Topics& topics) {
  for (fast::Topic* const topic : {topics.requests, topics.responses}) {
    if (topic == nullptr) continue;
    const std::string type = topic->get_type_name();
    port.participant->delete_topic(topic);
    port.participant->unregister_type(type);  // refused while another service has it
  }
}

// The endpoints for clients last: a client that discovers them finds a service that can be reached.
void ServiceLink::MakeEndpoints(const BridgedService& service) {
  MakeTopics(ports_.run, service, run_topics_);
  MakeTopics(ports_.clients, service, client_topics_);
  // Tools discover these too, and are not to recognize them as a service.
  from_service_ = ports_.run.subscriber->create_datareader(
      run_topics_.responses, ReaderQos(TypeMarkIn(service.response.user_data)), response_events_.get());
  to_service_ = ports_.run.publisher->create_datawriter(
      run_topics_.requests, WriterQos(TypeMarkIn(service.request.user_data)), to_service_events_.get());
  responses_ = ports_.clients.publisher->create_datawriter(
      client_topics_.responses, WriterQos(service.response.user_data), to_clients_events_.get());
  requests_ = ports_.clients.subscriber->create_datareader(client_topics_.requests,
                                                           ReaderQos(service.request.user_data), request_events_.get());
  if (from_service_ == nullptr || to_service_ == nullptr || responses_ == nullptr || requests_ == nullptr) {
    throw std::runtime_error("cannot bridge the service of the topic " + service.request.topic);
  }
}

void ServiceLink::DeleteEndpoints() {
  if (requests_ != nullptr) ports_.clients.subscriber->delete_datareader(requests_);
  if (responses_ != nullptr) ports_.clients.publisher->delete_datawriter(responses_);
  if (to_service_ != nullptr) ports_.run.publisher->delete_datawriter(to_service_);
  if (from_service_ != nullptr) ports_.run.subscriber->delete_datareader(from_service_);
  DeleteTopics(ports_.clients, client_topics_);
  DeleteTopics(ports_.run, run_topics_);
}

bool ServiceLink::ServiceIsMatched() const {
  const std::lock_guard lock(mutex_);
  return matched_[kReaders] > 0 && matched_[kWriters] > 0;
}

// A client that names the writer of its requests instead of a reader cannot be looked for.
bool ServiceLink::CanRespond(const Guid& endpoint) const {
  const std::lock_guard lock(mutex_);
  return !IsReader(endpoint) || client_readers_.contains(endpoint);
}

void ServiceLink::Process(PendingCalls::Time now) {
  std::vector<Guid> departed;
  {
    const std::lock_guard lock(mutex_);
    departed.swap(departed_readers_);
  }
  for (const Guid& reader : departed) calls_.Forget(reader);
  ReadResponses();
  ReadRequests(now);
  if (!ServiceIsMatched()) return;
  calls_.SendDue(
      now, [this](const Guid& endpoint) { return CanRespond(endpoint); },
      [this](std::int64_t number, const Bytes& request) {
        std::optional<Bytes> sample = WithHeader(request, {ports_.client_guid, number});
        if (sample) to_service_->write(&*sample);
      });
}

std::optional<PendingCalls::Time> ServiceLink::NextDue() const {
  return ServiceIsMatched() ? calls_.NextDue() : std::nullopt;
}

void ServiceLink::ReadRequests(PendingCalls::Time now) {
  Bytes request;
  fast::SampleInfo info;
  while (requests_->take_next_sample(&request, &info) == ReturnCode_t::RETCODE_OK) {
    const Guid writer = ToGuid(info.sample_identity.writer_guid());
    if (!info.valid_data || IsOfCyclone(writer)) continue;  // the service answers that itself
    const rtps::GUID_t& related = info.related_sample_identity.writer_guid();
    const bool names_reader = related != rtps::GUID_t::unknown();
    const Caller caller = {names_reader ? ToGuid(related) : writer, ToNumber(info.sample_identity.sequence_number())};
    calls_.Add(++*ports_.last_call, caller, std::move(request), now);
    request.clear();
  }
}

void ServiceLink::ReadResponses() {
  Bytes response;
  fast::SampleInfo info;
  while (from_service_->take_next_sample(&response, &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    std::optional<HeadedSample> split = SplitHeader(response);
    if (!split || split->header.client_guid != ports_.client_guid) continue;  // for another client
    calls_.ServiceAnswers();
    const std::optional<Caller> caller = calls_.TakeCaller(split->header.sequence_number);
    if (caller) Respond(*caller, split->sample);
  }
}

void ServiceLink::Respond(const Caller& caller, Bytes& response) {
  rtps::WriteParams parameters;
  parameters.related_sample_identity().writer_guid(FromGuid(caller.endpoint));
  parameters.related_sample_identity().sequence_number(FromNumber(caller.number));
  responses_->write(&response, parameters);
}

}  // namespace troupe::ros
