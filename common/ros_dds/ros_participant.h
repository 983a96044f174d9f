// RosParticipant: the DDS participant of a process in a ROS 2 domain, and its nodes. Readers and writers
// (ros_endpoints.h) belong to a node; Announce publishes the nodes and their endpoints, as the ROS graph needs.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/dds/binding/domain_participant.h"
#include "common/dds/binding/publisher.h"
#include "common/ros/ros_options.h"
#include "common/ros_dds/writer_watch.h"

namespace troupe::ros {

class RosParticipant {
 public:
  // `enclave`: whose keys it has if the options ask for security: kWorldEnclave, "/<robot>", or "/" of other programs.
  // Throws dds::Exception when DDS cannot start, or where FindEnclave fails.
  explicit RosParticipant(const RosOptions& options, const std::string& enclave = "/");
  ~RosParticipant();

  const dds::DomainParticipant& participant() const { return participant_; }
  const dds::Publisher& publisher() const { return publisher_; }
  const dds::Subscriber& subscriber() const { return subscriber_; }
  // Of services. With a bridge they are in its partition.
  const dds::Publisher& service_publisher() const { return service_publisher_; }
  const dds::Subscriber& service_subscriber() const { return service_subscriber_; }
  Distribution distribution() const { return distribution_; }

  // `node_namespace` begins with a slash, `name` has none. Returns the index of the node.
  std::size_t AddNode(const std::string& node_namespace, const std::string& name);
  // `accepts_best_effort`: a best-effort writer on its topic is no mismatch.
  void AddReader(std::size_t node, dds_entity_t reader, bool accepts_best_effort = false);
  void AddWriter(std::size_t node, dds_entity_t writer);
  // Publishes the nodes and their endpoints. Call after all are made, and again after a change.
  void Announce();

  // Looks from now on for writers that do not match the readers added after this call. DrainMismatches must be called
  // now and then, because all writers of the domain are kept for it.
  void WatchWriters();
  // Reports, once, a participant of a distribution with another layout of the list of nodes, too. After WatchWriters.
  void WatchDistributions();
  // A line for each writer, found since the last call, that does not match. As WriterWatch.
  std::vector<std::string> DrainMismatches();

  // How many readers the writers of its nodes have matched so far.
  void CountReader() { readers_.fetch_add(1, std::memory_order_relaxed); }
  std::uint64_t reader_count() const { return readers_.load(std::memory_order_relaxed); }

  // Samples that could not be written.
  void CountLost() { lost_.fetch_add(1, std::memory_order_relaxed); }
  std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  class Announcer;

  RosParticipant(const RosOptions& options, const Enclave& enclave);

  Distribution distribution_;
  dds::DomainParticipant participant_;
  dds::Publisher publisher_;
  dds::Subscriber subscriber_;
  dds::Publisher service_publisher_;
  dds::Subscriber service_subscriber_;
  std::unique_ptr<Announcer> announcer_;
  std::optional<WriterWatch> watch_;  // guarded by the mutex of the nodes
  std::atomic<std::uint64_t> readers_ = 0;
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

// Whether `writer` matches a reader of the participant that owns the writer `publication`, which `reader` matches.
bool HasReaderOf(dds_entity_t writer, dds_entity_t reader, dds_instance_handle_t publication);

// 16 random bytes as ROS writes them, "01.0f.10...".
std::string NewServiceId();

RosNode MakeNode(RosParticipant& participant, const std::string& node_namespace, const std::string& name);

}  // namespace troupe::ros
