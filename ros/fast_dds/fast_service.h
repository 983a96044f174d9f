// FastService: a service of the host for clients on Fast DDS, as rmw_fastrtps calls it. It passes each request on with
// the header of rmw_cyclonedds in front, and returns the response of that number to its caller.
// Why it exists at all: clients on Fast DDS know a call by the writer and sequence number of its request, and expect
// both in an inline parameter of the response, which a program on Cyclone DDS cannot write.
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <functional>
#include <mutex>
#include <set>
#include <span>

#include "ros/fast_dds/pending_calls.h"
#include "ros/link/link.h"
#include "ros/messages/ros_options.h"

namespace troupe::ros {

// A participant on Fast DDS in a ROS domain, in no partition, as participants of ROS are.
class FastDomain {
 public:
  // Throws std::runtime_error if it cannot be made.
  FastDomain(const RosNetwork& network, std::uint32_t domain);
  ~FastDomain();
  FastDomain(const FastDomain&) = delete;
  FastDomain& operator=(const FastDomain&) = delete;

  eprosima::fastdds::dds::Topic* MakeTopic(const std::string& name, const std::string& type) const;
  void DeleteTopic(eprosima::fastdds::dds::Topic* topic) const;
  eprosima::fastdds::dds::Publisher* publisher() const { return publisher_; }
  eprosima::fastdds::dds::Subscriber* subscriber() const { return subscriber_; }

 private:
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
};

class FastService final : private eprosima::fastdds::dds::DataReaderListener,
                          private eprosima::fastdds::dds::DataWriterListener {
 public:
  // Numbers the calls of all services of a process: a service may be rebuilt.
  using NextNumber = std::function<std::int64_t()>;
  using Pass = std::function<void(const Bytes& request)>;

  // `guid`: of the client in the header of each request. `next_number` and `pass` are called on threads of Fast DDS.
  // The domain must outlive this. Throws std::runtime_error if an endpoint cannot be made.
  FastService(const FastDomain& domain, const MadeText& service, Distribution distribution, std::uint64_t guid,
              NextNumber next_number, Pass pass);
  ~FastService() override;
  FastService(const FastService&) = delete;
  FastService& operator=(const FastService&) = delete;

  ServedContent endpoints() const;

  // `response`: with a header; without effect if no client waits for it.
  void Respond(std::span<const std::uint8_t> response);

 private:
  using Endpoint = eprosima::fastrtps::rtps::GUID_t;

  void on_data_available(eprosima::fastdds::dds::DataReader* reader) override;
  void on_publication_matched(eprosima::fastdds::dds::DataWriter* writer,
                              const eprosima::fastdds::dds::PublicationMatchedStatus& status) override;
  void SendReady();
  void Delete();

  const FastDomain& domain_;
  const std::uint64_t guid_;
  const NextNumber next_number_;
  const Pass pass_;
  // Guards the two below. No function of Fast DDS is called while it is held, because its threads wait for it.
  std::mutex mutex_;
  std::set<Endpoint> client_readers_;
  PendingCalls<Endpoint> calls_;
  eprosima::fastdds::dds::Topic* request_topic_ = nullptr;
  eprosima::fastdds::dds::Topic* response_topic_ = nullptr;
  eprosima::fastdds::dds::DataWriter* responses_ = nullptr;
  eprosima::fastdds::dds::DataReader* requests_ = nullptr;
};

}  // namespace troupe::ros
