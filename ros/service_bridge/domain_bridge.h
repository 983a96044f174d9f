// DomainBridge: two participants on Fast DDS in one ROS domain, and a link for each service of the run there.
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ros/messages/robot_list.h"
#include "ros/messages/ros_options.h"
#include "ros/service_bridge/bridge_network.h"
#include "ros/service_bridge/service_link.h"

namespace troupe::ros {

class DomainBridge final : private eprosima::fastdds::dds::DomainParticipantListener {
 public:
  // `inbox` and `last_call` (LinkPorts) must outlive this. `report`: receives problems, one line each. Throws
  // std::runtime_error if the participant cannot be made.
  DomainBridge(const RosOptions& options, Inbox& inbox, std::uint64_t client_guid, std::int64_t& last_call,
               std::function<void(const std::string&)> report);
  ~DomainBridge() override;
  DomainBridge(const DomainBridge&) = delete;
  DomainBridge& operator=(const DomainBridge&) = delete;

  // `parts`: those that were notified.
  void Process(const std::set<Inbox::PartId>& parts, PendingCalls::Time now);
  // Services of these robots are made anew when another robot of their process is deleted: clients do not notice it.
  // Other services end with their endpoints.
  void SetRobots(const RobotList& robots, PendingCalls::Time now);
  // The participant that discovers the services.
  const LinkPort& run() const { return ports_.run; }
  // When Process has something to do without a notification.
  std::optional<PendingCalls::Time> NextDue() const;

 private:
  // Of an endpoint of the run.
  struct Change {
    Guid guid{};
    std::optional<ServiceEndpoint> endpoint;  // nothing: it is gone
  };
  struct BridgedLink {
    std::unique_ptr<ServiceLink> link;
    std::optional<PendingCalls::Time> end;  // of a service without endpoints
  };

  using ReaderInfo = eprosima::fastrtps::rtps::ReaderDiscoveryInfo;
  using WriterInfo = eprosima::fastrtps::rtps::WriterDiscoveryInfo;
  void on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant* participant, ReaderInfo&& info) override;
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant, WriterInfo&& info) override;
  template <typename Data>
  void Note(const Data& data, bool removed);

  void Follow(const std::string& service, bool added, PendingCalls::Time now);
  void EndLinks(PendingCalls::Time now);
  LinkPort MakePort(const RosOptions& options, BridgeSide side);
  static void DeletePort(const LinkPort& port);

  const std::string partition_;
  const std::function<void(const std::string&)> report_;
  const Inbox::PartId part_;
  LinkPorts ports_;
  ServiceDirectory services_;
  RobotList robots_;
  std::mutex mutex_;  // guards changes_
  std::vector<Change> changes_;
  std::map<std::string, BridgedLink> links_;  // by service
  std::map<Inbox::PartId, ServiceLink*> link_of_;
};

}  // namespace troupe::ros
