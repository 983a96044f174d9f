#include "ros/service_bridge/domain_bridge.h"

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <stdexcept>
#include <utility>

#include "ros/service_bridge/fast_guid.h"

namespace troupe::ros {
namespace {

namespace fast = eprosima::fastdds::dds;
using eprosima::fastrtps::rtps::ReaderDiscoveryInfo;
using eprosima::fastrtps::rtps::WriterDiscoveryInfo;

// In which the services of a robot are made anew.
constexpr std::chrono::seconds kLinger{2};
// Changes that the bridge has not followed yet; a hostile participant makes more of them.
constexpr std::size_t kMostChanges = 100'000;
// Bytes. ROS writes about 120.
constexpr std::size_t kMostUserData = 4096;

bool IsIn(const std::string& partition, const fast::PartitionQosPolicy& policy) {
  for (auto entry = policy.begin(); entry != policy.end(); ++entry) {
    if (partition == entry->name()) return true;
  }
  return false;
}

}  // namespace

DomainBridge::DomainBridge(const RosOptions& options, Inbox& inbox, std::uint64_t client_guid, std::int64_t& last_call,
                           std::function<void(const std::string&)> report)
    : partition_(BridgePartition(options.session)), report_(std::move(report)), part_(inbox.NewPart()) {
  ports_.inbox = &inbox;
  ports_.client_guid = client_guid;
  ports_.last_call = &last_call;
  ports_.clients = MakePort(options, BridgeSide::kClients);
  try {
    ports_.run = MakePort(options, BridgeSide::kRun);
  } catch (...) {
    DeletePort(ports_.clients);
    throw;
  }
}

DomainBridge::~DomainBridge() {
  ports_.run.participant->set_listener(nullptr);
  links_.clear();
  DeletePort(ports_.run);
  DeletePort(ports_.clients);
}

// Only the participant in the run listens for services.
LinkPort DomainBridge::MakePort(const RosOptions& options, BridgeSide side) {
  const bool in_run = side == BridgeSide::kRun;
  LinkPort port;
  port.participant = fast::DomainParticipantFactory::get_instance()->create_participant(
      options.domain, BridgeNetwork(options, side), in_run ? this : nullptr, fast::StatusMask::none());
  if (port.participant == nullptr) {
    throw std::runtime_error("cannot make a participant in the ROS domain " + std::to_string(options.domain));
  }
  fast::PublisherQos publisher;
  fast::SubscriberQos subscriber;
  if (in_run) {
    publisher.partition().push_back(partition_.c_str());
    subscriber.partition().push_back(partition_.c_str());
  }
  port.publisher = port.participant->create_publisher(publisher);
  port.subscriber = port.participant->create_subscriber(subscriber);
  if (port.publisher == nullptr || port.subscriber == nullptr) {
    DeletePort(port);
    throw std::runtime_error("cannot make a publisher or a subscriber");
  }
  return port;
}

void DomainBridge::DeletePort(const LinkPort& port) {
  port.participant->set_listener(nullptr);
  port.participant->delete_contained_entities();
  fast::DomainParticipantFactory::get_instance()->delete_participant(port.participant);
}

template <typename Data>
void DomainBridge::Note(const Data& data, bool removed) {
  Change change{ToGuid(data.guid()), std::nullopt};
  if (!removed) {
    if (!IsIn(partition_, data.m_qos.m_partition)) return;
    const auto user_data = data.m_qos.m_userData.getValue();
    if (user_data.size() > kMostUserData) return;
    change.endpoint = {data.topicName().to_string(), data.typeName().to_string(), {user_data.begin(), user_data.end()}};
  }
  {
    const std::lock_guard lock(mutex_);
    if (changes_.size() >= kMostChanges) return;
    changes_.push_back(std::move(change));
  }
  ports_.inbox->Notify(part_);
}

void DomainBridge::on_subscriber_discovery(fast::DomainParticipant*, ReaderDiscoveryInfo&& info) {
  if (!info.info.topicName().to_string().starts_with("rq/")) return;
  Note(info.info, info.status == ReaderDiscoveryInfo::REMOVED_READER);
}

void DomainBridge::on_publisher_discovery(fast::DomainParticipant*, WriterDiscoveryInfo&& info) {
  if (!info.info.topicName().to_string().starts_with("rr/")) return;
  Note(info.info, info.status == WriterDiscoveryInfo::REMOVED_WRITER);
}

void DomainBridge::Process(const std::set<Inbox::PartId>& parts, PendingCalls::Time now) {
  if (parts.contains(part_)) {
    std::vector<Change> changes;
    {
      const std::lock_guard lock(mutex_);
      changes.swap(changes_);
    }
    for (const Change& change : changes) {
      const bool added = change.endpoint.has_value();
      const auto service = added ? services_.Add(change.guid, *change.endpoint) : services_.Remove(change.guid);
      if (service) Follow(*service, added, now);
    }
  }
  for (const auto& [part, link] : link_of_) {
    if (parts.contains(part) || link->NextDue().value_or(PendingCalls::Time::max()) <= now) link->Process(now);
  }
  EndLinks(now);
}

void DomainBridge::Follow(const std::string& service, bool added, PendingCalls::Time now) {
  const std::optional<BridgedService> found = services_.Find(service);
  const auto bridged = links_.find(service);
  if (!found) {
    if (bridged != links_.end()) bridged->second.end = robots_.HasService(service) ? now + kLinger : now;
    return;
  }
  if (bridged != links_.end()) {
    bridged->second.end.reset();
    if (added) bridged->second.link->ServiceChanges();
    return;
  }
  try {
    auto link = std::make_unique<ServiceLink>(ports_, *found);
    link_of_[link->part()] = link.get();
    links_[service] = {std::move(link), std::nullopt};
  } catch (const std::runtime_error& error) {
    report_(error.what());
  }
}

void DomainBridge::SetRobots(const RobotList& robots, PendingCalls::Time now) {
  robots_ = robots;
  for (auto& [service, bridged] : links_) {
    if (bridged.end && !robots_.HasService(service)) bridged.end = now;
  }
}

void DomainBridge::EndLinks(PendingCalls::Time now) {
  for (auto bridged = links_.begin(); bridged != links_.end();) {
    if (!bridged->second.end || *bridged->second.end > now) {
      ++bridged;
      continue;
    }
    link_of_.erase(bridged->second.link->part());
    bridged = links_.erase(bridged);
  }
}

std::optional<PendingCalls::Time> DomainBridge::NextDue() const {
  std::optional<PendingCalls::Time> next;
  const auto note = [&next](const std::optional<PendingCalls::Time>& time) {
    if (time) next = std::min(next.value_or(*time), *time);
  };
  for (const auto& [service, bridged] : links_) {
    note(bridged.end);
    note(bridged.link->NextDue());
  }
  return next;
}

}  // namespace troupe::ros
