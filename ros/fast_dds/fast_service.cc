#include "ros/fast_dds/fast_service.h"

#include <arpa/inet.h>
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <ifaddrs.h>
#include <netdb.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "ros/connection/ros_network.h"
#include "ros/connection/type_descriptions.h"
#include "ros/fast_dds/rtps_datagram.h"

namespace troupe::ros {
namespace {

// RawType: a DDS type whose samples are the serialized bytes themselves, whatever their layout: this side does not look
// into messages.
class RawType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  // `name`: of the type on DDS. Its samples are Bytes, with the 4 bytes that state the encoding.
  explicit RawType(const std::string& name);

  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override { return new Bytes(); }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

constexpr std::uint32_t kUsualSize = 256;

RawType::RawType(const std::string& name) {
  setName(name.c_str());
  m_typeSize = kUsualSize;
  m_isGetKeyDefined = false;
  // Cyclone DDS 0.10 cannot parse announcements with descriptions of types.
  auto_fill_type_object(false);
  auto_fill_type_information(false);
}

bool RawType::serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) {
  const Bytes& bytes = *static_cast<const Bytes*>(data);
  if (bytes.size() > payload->max_size || bytes.size() < 2) return false;
  std::memcpy(payload->data, bytes.data(), bytes.size());
  payload->length = static_cast<std::uint32_t>(bytes.size());
  payload->encapsulation = bytes[1] == 0 ? CDR_BE : CDR_LE;
  return true;
}

bool RawType::deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) {
  static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
  return true;
}

std::function<std::uint32_t()> RawType::getSerializedSizeProvider(void* data) {
  return [data] { return static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size()); };
}

// How a participant on Fast DDS discovers others: as those on Cyclone DDS in the ROS domain
// (ros/connection/ros_network.h).

// It and participants on Cyclone DDS do not discover each other. Throws std::runtime_error if the network interface or
// a static peer has no address.
eprosima::fastdds::dds::DomainParticipantQos FastNetwork(const RosNetwork& network);

// ApartTransport: a transport of Fast DDS by which a participant and those of Cyclone DDS do not discover each other. A
// client on Cyclone calls the services themselves, and cannot read the responses of this one. It passes on only the
// parts of a datagram that are safe to read.

// `low_level`: the transport that sends and receives.
std::shared_ptr<eprosima::fastdds::rtps::ChainingTransportDescriptor> ApartFromCyclone(
    const std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>& low_level);

using eprosima::fastdds::rtps::ChainingTransport;
using eprosima::fastdds::rtps::ChainingTransportDescriptor;
using eprosima::fastdds::rtps::TransportDescriptorInterface;
using eprosima::fastdds::rtps::TransportInterface;
using eprosima::fastdds::rtps::TransportReceiverInterface;
using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::rtps::LocatorsIterator;
using eprosima::fastrtps::rtps::octet;
using eprosima::fastrtps::rtps::SenderResource;

constexpr std::string_view kTag = "troupe_fast_dds";

class ApartDescriptor final : public ChainingTransportDescriptor {
 public:
  using ChainingTransportDescriptor::ChainingTransportDescriptor;
  TransportInterface* create_transport() const override;
};

class ApartTransport final : public ChainingTransport {
 public:
  explicit ApartTransport(const ApartDescriptor& descriptor) : ChainingTransport(descriptor), descriptor_(descriptor) {}

  TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(SenderResource* sender, const octet* bytes, std::uint32_t size, LocatorsIterator* begin,
            LocatorsIterator* end, const std::chrono::steady_clock::time_point& timeout) override {
    const std::optional<Bytes> tagged = WithDomainTag({bytes, size}, kTag);
    if (!tagged) return sender->send(bytes, size, begin, end, timeout);
    return sender->send(tagged->data(), static_cast<std::uint32_t>(tagged->size()), begin, end, timeout);
  }
  void receive(TransportReceiverInterface* receiver, const octet* bytes, std::uint32_t size, const Locator_t& local,
               const Locator_t& remote) override {
    if (IsFromCyclone({bytes, size})) return;
    const std::optional<Bytes> safe = SafeParts({bytes, size});
    if (safe) receiver->OnDataReceived(safe->data(), static_cast<std::uint32_t>(safe->size()), local, remote);
  }

 private:
  ApartDescriptor descriptor_;
};

TransportInterface* ApartDescriptor::create_transport() const {
  return new ApartTransport(*this);
}

std::shared_ptr<ChainingTransportDescriptor> ApartFromCyclone(
    const std::shared_ptr<TransportDescriptorInterface>& low_level) {
  return std::make_shared<ApartDescriptor>(low_level);
}

using eprosima::fastdds::dds::DomainParticipantQos;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::rtps::IPLocator;

constexpr const char* kLoopbackAddress = "127.0.0.1";
constexpr const char* kDiscoveryGroup = "239.255.0.1";
// s. The services of a process that was killed disappear for others after its lease.
constexpr std::int32_t kLease = 10;
constexpr std::int32_t kAnnouncementPeriod = 1;

bool IsAddress(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

std::string AddressOfInterface(const std::string& name) {
  if (IsAddress(name)) return name;
  std::string address;
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) == 0) {
    for (const ifaddrs* entry = first; entry != nullptr && address.empty(); entry = entry->ifa_next) {
      if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET || name != entry->ifa_name) continue;
      char text[INET_ADDRSTRLEN] = "";
      inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(entry->ifa_addr)->sin_addr, text, sizeof text);
      address = text;
    }
    freeifaddrs(first);
  }
  if (address.empty()) throw std::runtime_error("the network interface '" + name + "' has no IPv4 address");
  return address;
}

std::string AddressOfHost(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0) {
    throw std::runtime_error("found no address of the static peer '" + host + "'");
  }
  char text[INET_ADDRSTRLEN] = "";
  inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(found->ai_addr)->sin_addr, text, sizeof text);
  freeaddrinfo(found);
  return text;
}

// Fast DDS fills in the ports: of multicast, or of the first participant indices.
void AddPeer(DomainParticipantQos& qos, const std::string& address) {
  Locator_t locator;
  IPLocator::setIPv4(locator, address);
  qos.wire_protocol().builtin.initialPeersList.push_back(locator);
}

DomainParticipantQos FastNetwork(const RosNetwork& network) {
  // Without shared memory, whose layout in the programs of a ROS distribution can be that of another version.
  auto transport = std::make_shared<UDPv4TransportDescriptor>();
  transport->maxInitialPeersRange = IndicesSearched(network.distribution);
  if (network.discovery == DiscoveryRange::kLocalhost) transport->TTL = 0;  // multicast stays on this machine
  const bool local = AnnouncesOnLoopback(network);
  if (UsesLoopbackOnly(network)) {
    transport->interfaceWhiteList = {kLoopbackAddress};
  } else if (network.network_interface != "auto") {
    transport->interfaceWhiteList = {AddressOfInterface(network.network_interface)};
    if (local) transport->interfaceWhiteList.emplace_back(kLoopbackAddress);
  }
  DomainParticipantQos qos;
  qos.name("ros_participant");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(ApartFromCyclone(transport));
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.leaseDuration = {kLease, 0};
  discovery.leaseDuration_announcementperiod = {kAnnouncementPeriod, 0};
  AddPeer(qos, kDiscoveryGroup);
  if (local) AddPeer(qos, kLoopbackAddress);
  if (network.discovery != DiscoveryRange::kSystemDefault) {
    for (const std::string& peer : network.static_peers) AddPeer(qos, AddressOfHost(peer));
  }
  // As a participant of ROS; its endpoints belong to no node.
  const std::string enclave = "enclave=/;";
  qos.user_data().setValue({enclave.begin(), enclave.end()});
  return qos;
}

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::types::ReturnCode_t;

// Samples of an endpoint: requests that are still to be read, responses that a slow client may still get.
constexpr std::int32_t kMaxSamples = 1000;
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

Guid BytesOf(const rtps::GUID_t& guid) {
  Guid bytes;
  std::copy_n(guid.guidPrefix.value, rtps::GuidPrefix_t::size, bytes.begin());
  std::copy_n(guid.entityId.value, rtps::EntityId_t::size, bytes.begin() + rtps::GuidPrefix_t::size);
  return bytes;
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
  qos.resource_limits().max_samples = kMaxSamples;
  qos.resource_limits().max_instances = 1;
  qos.resource_limits().max_samples_per_instance = kMaxSamples;
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

FastService::FastService(const FastDomain& domain, const MadeText& service, Distribution distribution,
                         std::uint64_t guid, NextNumber next_number, Pass pass)
    : domain_(domain), guid_(guid), next_number_(std::move(next_number)), pass_(std::move(pass)) {
  request_topic_ = domain.MakeTopic("rq" + service.name + "Request", service.type);
  response_topic_ = domain.MakeTopic("rr" + service.name + "Reply", service.response_type);
  if (request_topic_ != nullptr && response_topic_ != nullptr) {
    // Keeps the last samples only, so that a reader that hangs does not make a write wait.
    auto to_clients = ServiceQos<fast::DataWriterQos>(distribution, service.response_type);
    to_clients.history().kind = fast::KEEP_LAST_HISTORY_QOS;
    to_clients.history().depth = kMaxSamples;
    to_clients.reliable_writer_qos().times.heartbeatPeriod = {0, kHeartbeatNanoseconds};
    responses_ = domain.publisher()->create_datawriter(response_topic_, to_clients, this);
    auto from_clients = ServiceQos<fast::DataReaderQos>(distribution, service.type);
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

ServedContent FastService::endpoints() const {
  return {BytesOf(requests_->guid()), BytesOf(responses_->guid())};
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
    caller = calls_.RemoveCaller(split->header.sequence_number);
  }
  if (!caller) return;
  rtps::WriteParams parameters;
  parameters.related_sample_identity().writer_guid(caller->endpoint);
  parameters.related_sample_identity().sequence_number(FromNumber(caller->number));
  responses_->write(&split->sample, parameters);
}

}  // namespace troupe::ros
