// ServiceLink: one service of the run for clients on Fast DDS. A reader of requests and a writer of responses serve the
// clients; a writer of requests and a reader of responses, in the partition of the run, are a client of the service.
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ros/service_bridge/inbox.h"
#include "ros/service_bridge/pending_calls.h"
#include "ros/service_bridge/service_directory.h"

namespace troupe::ros {

// A participant of the bridge.
struct LinkPort {
  eprosima::fastdds::dds::DomainParticipant* participant = nullptr;
  eprosima::fastdds::dds::Publisher* publisher = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber = nullptr;
};

// What all links in a domain share.
struct LinkPorts {
  LinkPort clients;  // in no partition, as the endpoints of ROS
  LinkPort run;      // in the partition of the run
  Inbox* inbox = nullptr;
  std::uint64_t client_guid = 0;  // of the bridge
  // Of the bridge's calls, not of a link's: a service may outlive its link.
  std::int64_t* last_call = nullptr;
};

class ServiceLink {
 public:
  // Throws std::runtime_error if an endpoint cannot be made.
  ServiceLink(const LinkPorts& ports, const BridgedService& service);
  ~ServiceLink();
  ServiceLink(const ServiceLink&) = delete;
  ServiceLink& operator=(const ServiceLink&) = delete;

  Inbox::PartId part() const { return part_; }

  // Passes on the requests and responses that have arrived, and sends again the calls that are due.
  void Process(PendingCalls::Time now);
  // When Process has something to do without being notified.
  std::optional<PendingCalls::Time> NextDue() const;
  // The service has endpoints that are new.
  void ServiceChanges() { calls_.ServiceChanges(); }

 private:
  class ReaderEvents;
  class WriterEvents;

  void MakeEndpoints(const BridgedService& service);
  void DeleteEndpoints();
  struct Topics {
    eprosima::fastdds::dds::Topic* requests = nullptr;
    eprosima::fastdds::dds::Topic* responses = nullptr;
  };
  static void MakeTopics(const LinkPort& port, const BridgedService& service, Topics& topics);
  static void DeleteTopics(const LinkPort& port, const Topics& topics);
  void ReadRequests(PendingCalls::Time now);
  void ReadResponses();
  void Respond(const Caller& caller, Bytes& response);
  bool ServiceIsMatched() const;
  bool CanRespond(const Guid& endpoint) const;

  const LinkPorts ports_;
  const Inbox::PartId part_;
  PendingCalls calls_;

  mutable std::mutex mutex_;  // guards the three below, which the threads of Fast DDS change
  std::set<Guid> client_readers_;
  std::vector<Guid> departed_readers_;
  int matched_[2] = {0, 0};  // endpoints of the service: its readers of requests, its writers of responses

  std::unique_ptr<ReaderEvents> request_events_;
  std::unique_ptr<ReaderEvents> response_events_;
  std::unique_ptr<WriterEvents> to_service_events_;
  std::unique_ptr<WriterEvents> to_clients_events_;
  Topics client_topics_;
  Topics run_topics_;
  eprosima::fastdds::dds::DataReader* requests_ = nullptr;      // of clients
  eprosima::fastdds::dds::DataWriter* responses_ = nullptr;     // to clients
  eprosima::fastdds::dds::DataWriter* to_service_ = nullptr;    // requests
  eprosima::fastdds::dds::DataReader* from_service_ = nullptr;  // responses
};

}  // namespace troupe::ros
