#include "ros/fast_dds/fast_service.h"

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "ros/connection/type_hash.h"
#include "ros/fast_dds/fast_network.h"
#include "ros/fast_dds/raw_type.h"

namespace troupe::ros {
namespace {

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::types::ReturnCode_t;

// Samples of an endpoint: requests that are still to be read, responses that a slow client may still get.
constexpr std::int32_t kMostSamples = 1000;
// A packet that is lost is sent again after this time, not after the usual 3 s.
constexpr std::uint32_t kHeartbeatNanoseconds = 100'000'000;

std::int64_t ToNumber(const rtps::SequenceNumber_t& number) {
  return std::int64_t{number.high} * (std::int64_t{1} << 32) + number.low;
}

rtps::SequenceNumber_t FromNumber(std::int64_t number) {
  return {static_cast<std::int32_t>(number >> 32), static_cast<std::uint32_t>(number)};
}

// Its client calls the Cyclone side itself.
bool IsOfCyclone(const rtps::GUID_t& guid) {
  return guid.guidPrefix.value[0] == 0x01 && guid.guidPrefix.value[1] == 0x10;
}

// RTPS 2.2, section 9.3.1.2.
bool IsReader(const rtps::GUID_t& guid) {
  return (guid.entityId.value[3] & 0x04U) != 0;
}

// The QoS of services in ROS, but that no request is lost in a burst. Samples have any size, so none is reserved.
template <typename Qos>
Qos ServiceQos(Distribution distribution, const std::string& type) {
  Qos qos;
  qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = fast::VOLATILE_DURABILITY_QOS;
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  qos.resource_limits().max_samples = kMostSamples;
  qos.resource_limits().max_instances = 1;
  qos.resource_limits().max_samples_per_instance = kMostSamples;
  qos.resource_limits().allocated_samples = 1;
  qos.data_sharing().off();
  const std::string mark = TypeMark(distribution, type);
  qos.user_data().setValue({mark.begin(), mark.end()});
  return qos;
}

}  // namespace

FastDomain::FastDomain(const RosNetwork& network, std::uint32_t domain)
    : participant_(fast::DomainParticipantFactory::get_instance()->create_participant(domain, FastNetwork(network))) {
  if (participant_ != nullptr) {
    publisher_ = participant_->create_publisher(fast::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT);
    if (publisher_ != nullptr && subscriber_ != nullptr) return;
    participant_->delete_contained_entities();
    fast::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  throw std::runtime_error("cannot make a participant on Fast DDS in the ROS domain " + std::to_string(domain));
}

FastDomain::~FastDomain() {
  participant_->delete_contained_entities();
  fast::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

fast::Topic* FastDomain::MakeTopic(const std::string& name, const std::string& type) const {
  if (participant_->find_type(type).empty()) fast::TypeSupport(new RawType(type)).register_type(participant_);
  return participant_->create_topic(name, type, fast::TOPIC_QOS_DEFAULT);
}

void FastDomain::DeleteTopic(fast::Topic* topic) const {
  if (topic == nullptr) return;
  const std::string type = topic->get_type_name();
  participant_->delete_topic(topic);
  participant_->unregister_type(type);  // refused while another service has it
}

FastService::FastService(const FastDomain& domain, const ServiceText& service, Distribution distribution,
                         std::uint64_t guid, NextNumber next_number, Pass pass)
    : domain_(domain), guid_(guid), next_number_(std::move(next_number)), pass_(std::move(pass)) {
  request_topic_ = domain.MakeTopic("rq" + service.name + "Request", service.request_type);
  response_topic_ = domain.MakeTopic("rr" + service.name + "Reply", service.response_type);
  if (request_topic_ != nullptr && response_topic_ != nullptr) {
    // Keeps the last samples only, so that a reader that hangs does not make a write wait.
    auto to_clients = ServiceQos<fast::DataWriterQos>(distribution, service.response_type);
    to_clients.history().kind = fast::KEEP_LAST_HISTORY_QOS;
    to_clients.history().depth = kMostSamples;
    to_clients.reliable_writer_qos().times.heartbeatPeriod = {0, kHeartbeatNanoseconds};
    responses_ = domain.publisher()->create_datawriter(response_topic_, to_clients, this);
    auto from_clients = ServiceQos<fast::DataReaderQos>(distribution, service.request_type);
    from_clients.history().kind = fast::KEEP_ALL_HISTORY_QOS;
    requests_ = domain.subscriber()->create_datareader(request_topic_, from_clients, this);
  }
  if (responses_ != nullptr && requests_ != nullptr) return;
  Delete();
  throw std::runtime_error("cannot serve " + service.name + " on Fast DDS");
}

FastService::~FastService() {
  Delete();
}

void FastService::Delete() {
  if (requests_ != nullptr) domain_.subscriber()->delete_datareader(requests_);
  if (responses_ != nullptr) domain_.publisher()->delete_datawriter(responses_);
  domain_.DeleteTopic(request_topic_);
  domain_.DeleteTopic(response_topic_);
}

void FastService::on_data_available(fast::DataReader* reader) {
  Bytes request;
  fast::SampleInfo info;
  while (reader->take_next_sample(&request, &info) == ReturnCode_t::RETCODE_OK) {
    const rtps::GUID_t& writer = info.sample_identity.writer_guid();
    if (!info.valid_data || IsOfCyclone(writer)) continue;
    const rtps::GUID_t& related = info.related_sample_identity.writer_guid();
    const bool names_reader = related != rtps::GUID_t::unknown();
    const std::lock_guard lock(mutex_);
    calls_.Add(next_number_(), {names_reader ? related : writer, ToNumber(info.sample_identity.sequence_number())},
               std::move(request), std::chrono::steady_clock::now());
    request.clear();
  }
  SendReady();
}

void FastService::on_publication_matched(fast::DataWriter*, const fast::PublicationMatchedStatus& status) {
  const rtps::GUID_t reader = rtps::iHandle2GUID(status.last_subscription_handle);
  {
    const std::lock_guard lock(mutex_);
    if (status.current_count_change > 0) {
      client_readers_.insert(reader);
    } else if (client_readers_.erase(reader) > 0) {
      calls_.Forget(reader);
    }
  }
  SendReady();
}

// A client that names the writer of its requests instead of a reader cannot be looked for.
void FastService::SendReady() {
  const std::lock_guard lock(mutex_);
  calls_.SendReady(
      [this](const Endpoint& endpoint) { return !IsReader(endpoint) || client_readers_.contains(endpoint); },
      [this](std::int64_t number, const Bytes& request) {
        if (const std::optional<Bytes> sample = WithHeader(request, {guid_, number})) pass_(*sample);
      });
}

void FastService::Respond(std::span<const std::uint8_t> response) {
  std::optional<HeadedSample> split = SplitHeader(response);
  if (!split) return;
  std::optional<PendingCalls<Endpoint>::Caller> caller;
  {
    const std::lock_guard lock(mutex_);
    caller = calls_.TakeCaller(split->header.sequence_number);
  }
  if (!caller) return;
  rtps::WriteParams parameters;
  parameters.related_sample_identity().writer_guid(caller->endpoint);
  parameters.related_sample_identity().sequence_number(FromNumber(caller->number));
  responses_->write(&split->sample, parameters);
}

}  // namespace troupe::ros
