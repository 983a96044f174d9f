// RosParticipant: a DDS participant in a ROS 2 domain, and its nodes. Readers and writers (ros_endpoints.h) belong to a
// node; Announce publishes the nodes and their endpoints, as the ROS graph needs: DDS itself knows no nodes, so each
// participant writes their list as one latched sample on ros_discovery_info.
//
// Each Announce writes the whole list again; its owner therefore joins changes and announces some milliseconds later.
// Calls are safe from any thread: one mutex guards the list and the watch of foreign writers. Layouts differ between
// Humble and later distributions (GUIDs of 24 bytes against 16, type hashes), hence one distribution for a participant.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ros/connection/ros_connection.h"
#include "ros/messages/ros_options.h"
#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/entity.h"

namespace troupe::ros {

struct Mismatch {
  std::string topic;   // on DDS: "rt/anna/cmd_vel"; empty: the distribution, of no topic
  std::string report;  // a line for users
};

// WriterWatch: finds writers on our readers' topics that match none of them, because the type differs or the writer is
// not reliable; and those of another run in the same domain. DDS itself does not report these, and a user would see
// only that a command has no effect.
class WriterWatch {
 public:
  explicit WriterWatch(const dds::DomainParticipant& participant);

  // Watches the topic of a reader. Several readers of a topic may have different types.
  void Expect(dds_entity_t reader, bool accepts_best_effort);

  // Replaces the reader of discovered writers: the next Drain considers all writers that exist.
  void Rediscover(const dds::DomainParticipant& participant);

  // Reports participants whose list of nodes has another layout than that of the distribution, and other writers of
  // /clock than those of this participant if it has one, too.
  void ExpectOneRun(Distribution distribution) {
    distribution_ = distribution;
    expects_one_clock_ = true;
  }

  // One for each topic and problem found since the last call. A single status read if discovery found nothing new.
  std::vector<Mismatch> Drain();

 private:
  struct Expected {
    std::set<std::string> types;
    bool reliable = true;  // no reader matches other writers
  };
  // The report on a writer; none if it matches, or if the same problem was reported.
  std::optional<std::string> Judge(const dds_builtintopic_endpoint_t& writer);
  std::optional<std::string> JudgeDistribution(const dds_builtintopic_endpoint_t& writer);
  std::optional<std::string> JudgeClock(const dds_builtintopic_endpoint_t& writer);

  dds_guid_t self_{};
  bool expects_one_clock_ = false;                          // and has not reported a second one
  bool has_clock_ = false;                                  // this participant
  bool has_other_clock_ = false;                            // another one
  dds::Entity publications_;                                // a reader of discovered writers
  std::map<std::string, Expected> expected_;                // by topic
  std::optional<Distribution> distribution_;                // none: not reported, or reported
  std::set<std::pair<std::string, std::string>> reported_;  // topic and problem
};

// In the user data of participants of runs, beside the enclave that ROS has there.
inline constexpr std::string_view kMarkOfRuns = "simulator=troupe;";

class RosParticipant final : public RosConnection {
 public:
  // A program, whose writers wait at their end for readers that have not acknowledged their samples, each for itself;
  // or the program ros-participant of a host, whose participants are marked. Their writers end at once: the owner calls
  // AwaitAcknowledgments before it ends the last ones.
  enum class Owner : std::uint8_t { kProgram, kHost };

  // `enclave`: whose keys it has if the network asks for security and names none. Throws dds::Exception when DDS cannot
  // start, or where FindEnclave fails.
  explicit RosParticipant(const RosNetwork& network, const std::string& enclave = "/", Owner owner = Owner::kProgram);
  ~RosParticipant() override;

  const dds::DomainParticipant& participant() const { return participant_; }
  const dds::Publisher& publisher() const { return publisher_; }
  const dds::Subscriber& subscriber() const { return subscriber_; }
  // The publisher of services. Those that Fast DDS serves too are in a partition that its clients do not match.
  const dds::Publisher& service_publisher() const { return service_publisher_; }
  const dds::Subscriber& service_subscriber() const { return service_subscriber_; }

  std::size_t AddNode(const std::string& node_namespace, const std::string& name) override;
  void RemoveNode(std::size_t node);
  std::unique_ptr<TopicWriter> MakeWriter(std::size_t node, const TopicSpec& spec) override;
  std::unique_ptr<TopicReader> MakeReader(std::size_t node, const TopicSpec& spec, Part part,
                                          std::function<void()> on_arrival) override;
  std::unique_ptr<ServiceServer> MakeService(std::size_t node, const ServiceSpec& spec,
                                             ServiceServer::Handler handler) override;
  // Lists a writer of MakeWriter as one of another node, too.
  void ShareWriter(std::size_t node, const TopicWriter& writer);

  // `accepts_best_effort`: a best-effort writer on its topic is no mismatch.
  void AddReader(std::size_t node, dds_entity_t reader, bool accepts_best_effort = false);
  void AddWriter(std::size_t node, dds_entity_t writer);
  // Lists a reader or writer no longer.
  void RemoveEndpoint(dds_entity_t endpoint);
  // Lists the endpoints of a service that another participant serves for the node, and no longer.
  void AddForeignService(std::size_t node, const Guid& reader, const Guid& writer);
  void RemoveForeignService(const Guid& reader, const Guid& writer);
  void Announce() override;
  // Waits until the readers have all samples, for this time at most.
  void AwaitAcknowledgments(double seconds) const;

  // Looks from now on for writers that do not match the readers added after this call. DrainMismatches must be called
  // now and then, because all writers of the domain are kept for it.
  void WatchWriters();
  // Reports, once each, a participant of a distribution with another layout of the list of nodes, and another run in
  // the domain of a run whose clock this participant writes, too. REQUIRES: WatchWriters was called.
  void WatchDistributions();
  // The writers that were found before the newest readers were added are compared with these, too.
  void WatchKnownWriters();
  std::vector<std::string> DrainMismatches() override;
  // The same with their topics.
  std::vector<Mismatch> DrainMismatchesOfTopics();

 private:
  class Announcer;

  RosParticipant(const RosNetwork& network, const Enclave& enclave, Owner owner);

  dds::DomainParticipant participant_;
  dds::Publisher publisher_;
  dds::Subscriber subscriber_;
  dds::Publisher service_publisher_;
  dds::Subscriber service_subscriber_;
  std::unique_ptr<Announcer> announcer_;
  std::optional<WriterWatch> watch_;  // guarded by the mutex of the nodes
};

}  // namespace troupe::ros
