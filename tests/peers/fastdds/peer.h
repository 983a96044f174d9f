// A participant on Fast DDS for the programs of this folder: on one interface; output in JSON lines.
#pragma once

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

using namespace eprosima::fastdds::dds;
using nlohmann::json;

inline void Print(const json& line) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  std::printf("%s\n", line.dump().c_str());
  std::fflush(stdout);
}

// Calls a function with each message, on one of Fast DDS's threads.
template <typename PubSubType>
class Listener : public DataReaderListener {
 public:
  using Message = typename PubSubType::type;
  using Consume = std::function<void(const Message&, const SampleInfo&)>;
  explicit Listener(Consume consume) : consume_(std::move(consume)) {}
  std::atomic<int> received = 0;
  void on_data_available(DataReader* reader) override {
    Message message;
    SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      consume_(message, info);
      ++received;
    }
  }

 private:
  Consume consume_;
};

// As rmw_fastrtps_cpp of Jazzy with ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST, without shared memory.
inline constexpr const char* kJazzyLocalhost = "localhost";

class Peer {
 public:
  // `address`: of its only network interface; "localhost": as kJazzyLocalhost.
  explicit Peer(std::uint32_t domain, DomainParticipantListener* listener = nullptr,
                const std::string& address = "127.0.0.1") {
    DomainParticipantQos qos;
    auto transport = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    if (address == kJazzyLocalhost) {
      DiscoverAsJazzyOnLocalhost(qos, *transport);
    } else {
      transport->interfaceWhiteList = {address};
    }
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(transport);
    participant_ =
        DomainParticipantFactory::get_instance()->create_participant(domain, qos, listener, StatusMask::none());
    if (participant_ == nullptr) throw std::runtime_error("cannot make a participant");
    subscriber_ = participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
    publisher_ = participant_->create_publisher(PUBLISHER_QOS_DEFAULT);
  }
  ~Peer() { Close(); }
  // No function given to Read is called after it returns.
  void Close() {
    if (participant_ == nullptr) return;
    participant_->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant_);
    participant_ = nullptr;
  }

  // A ROS topic begins with a slash and is "rt/..." on DDS; other names stay as they are. `received` is a count.
  template <typename PubSubType>
  DataReader* Read(const std::string& topic, std::function<void(const typename PubSubType::type&)> consume,
                   bool latched = false, const std::atomic<int>** received = nullptr) {
    return ReadWithInfo<PubSubType>(
        topic, [consume = std::move(consume)](const auto& message, const SampleInfo&) { consume(message); }, latched,
        received);
  }
  // The same with what the sample has beside the message.
  template <typename PubSubType>
  DataReader* ReadWithInfo(const std::string& topic, typename Listener<PubSubType>::Consume consume,
                           bool latched = false, const std::atomic<int>** received = nullptr) {
    DataReaderQos qos = DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = latched ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
    qos.history().kind = KEEP_ALL_HISTORY_QOS;
    qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
    auto listener = std::make_unique<Listener<PubSubType>>(std::move(consume));
    if (received != nullptr) *received = &listener->received;
    DataReader* const reader = subscriber_->create_datareader(MakeTopic<PubSubType>(topic), qos, listener.get());
    listeners_.push_back(std::move(listener));
    return reader;
  }

  template <typename PubSubType>
  DataWriter* Write(const std::string& topic) {
    DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    return publisher_->create_datawriter(MakeTopic<PubSubType>(topic), qos);
  }

 private:
  // It listens at unicast ports of all interfaces, and announces itself to the ports of 32 participants on this
  // machine.
  static void DiscoverAsJazzyOnLocalhost(DomainParticipantQos& qos,
                                         eprosima::fastdds::rtps::UDPv4TransportDescriptor& transport) {
    using eprosima::fastrtps::rtps::Locator_t;
    transport.maxInitialPeersRange = 32;
    auto& builtin = qos.wire_protocol().builtin;
    builtin.metatrafficMulticastLocatorList.clear();
    builtin.metatrafficUnicastLocatorList.push_back(Locator_t());  // else there is a multicast one by default
    Locator_t loopback;
    eprosima::fastrtps::rtps::IPLocator::setIPv4(loopback, "127.0.0.1");
    builtin.initialPeersList.push_back(loopback);
  }

  template <typename PubSubType>
  Topic* MakeTopic(const std::string& name) {
    TypeSupport type(new PubSubType());
    type.register_type(participant_);
    const std::string prefix = name.starts_with("/") ? "rt" : "";
    return participant_->create_topic(prefix + name, type.get_type_name(), TOPIC_QOS_DEFAULT);
  }

  DomainParticipant* participant_ = nullptr;
  Subscriber* subscriber_ = nullptr;
  Publisher* publisher_ = nullptr;
  std::vector<std::unique_ptr<DataReaderListener>> listeners_;
};
