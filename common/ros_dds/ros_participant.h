// RosParticipant: a process' presence in a ROS 2 domain, and the nodes that it shows there. Readers and writers
// (ros_endpoints.h) belong to a node; Announce tells everybody about them.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/dds/domain_participant.h"
#include "common/dds/publisher.h"
#include "common/ros/ros_options.h"
#include "common/ros_dds/writer_watch.h"

namespace troupe::ros {

class RosParticipant {
 public:
  // Throws dds::Exception when DDS cannot start.
  explicit RosParticipant(const RosOptions& options);
  ~RosParticipant();

  const dds::DomainParticipant& participant() const { return participant_; }
  const dds::Publisher& publisher() const { return publisher_; }
  const dds::Subscriber& subscriber() const { return subscriber_; }
  Distribution distribution() const { return distribution_; }

  // `node_namespace` begins with a slash, `name` has none. Returns what AddReader and AddWriter want.
  std::size_t AddNode(const std::string& node_namespace, const std::string& name);
  void AddReader(std::size_t node, dds_entity_t reader);
  void AddWriter(std::size_t node, dds_entity_t writer);
  // Tells the nodes and what they read and write. Call when all have been made, and again when that changed.
  void Announce();

  // Writers that readers of its nodes cannot read, since the last call: a line each. As WriterWatch.
  std::vector<std::string> TakeUnreadable();

  // Samples that could not be written.
  void CountLost() { lost_.fetch_add(1, std::memory_order_relaxed); }
  std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  class Announcer;

  Distribution distribution_;
  dds::DomainParticipant participant_;
  dds::Publisher publisher_;
  dds::Subscriber subscriber_;
  std::unique_ptr<Announcer> announcer_;
  WriterWatch watch_;  // guarded as the nodes are
  std::atomic<std::uint64_t> lost_ = 0;
};

// A node of a participant.
struct RosNode {
  RosParticipant* participant = nullptr;
  std::size_t index = 0;
  std::string node_namespace;  // "/anna"

  // "/anna/odom"; a name that begins with a slash stays as it is.
  std::string Resolve(const std::string& name) const {
    if (name.starts_with("/")) return name;
    return (node_namespace == "/" ? "" : node_namespace) + "/" + name;
  }
};

// Whether `writer` has met a reader of the participant whose writer `publication` sent something to `reader`.
bool HasReaderOf(dds_entity_t writer, dds_entity_t reader, dds_instance_handle_t publication);

// 16 bytes in the way of ROS, "01.0f.10...", different for each service of all processes.
std::string NewServiceId();

RosNode MakeNode(RosParticipant& participant, const std::string& node_namespace, const std::string& name);

}  // namespace troupe::ros
