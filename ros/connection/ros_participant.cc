#include "ros/connection/ros_participant.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <utility>

#include "ros/connection/dds_service.h"
#include "ros/connection/dds_topic.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/ros_qos.h"
#include "ros/connection/topic_types.h"
#include "ros/connection/user_data.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/binding/domain_config.h"
#include "transport/dds/binding/wire.h"

namespace troupe::ros {
namespace {

constexpr const char* kDiscoveryTopic = "ros_discovery_info";
constexpr std::size_t kLongestName = 256;

Enclave EnclaveOf(const RosNetwork& network, const std::string& name) {
  Result<Enclave> enclave = FindEnclave(network.security, name);
  if (!enclave.ok()) throw dds::Exception(DDS_RETCODE_BAD_PARAMETER, "starting ROS: " + enclave.error().ToString());
  return std::move(enclave).value();
}

dds::DomainConfig ConfigOf(const RosNetwork& network, const Enclave& enclave) {
  dds::DomainConfig config = NetworkConfig(network);
  config.security_enclave = enclave.folder;
  config.numbered_as_on_network = !enclave.folder.empty();  // permissions of ROS name its domain
  return config;
}

// Clients are in no partition: those on Cyclone DDS match "*", and those on Fast DDS, whose requests have no number of
// the call here, do not.
dds::Qos ServicePartitions(const RosNetwork& network) {
  return UsesFastDds(network) ? dds::Qos() << dds::Partitions{{"*"}} : dds::Qos();
}

using Guid = std::array<std::uint8_t, sizeof(dds_guid_t)>;

Guid GuidOf(dds_entity_t entity) {
  dds_guid_t guid{};
  dds::Check(dds_get_guid(entity, &guid), "reading an entity's GUID");
  Guid bytes;
  std::memcpy(bytes.data(), guid.v, sizeof guid.v);
  return bytes;
}

// The GUID, followed by zeros where the field of the distribution is longer.
template <typename Gid>
void Set(Gid& gid, const Guid& guid) {
  std::memset(gid.data, 0, sizeof gid.data);
  std::memcpy(gid.data, guid.data(), guid.size());
}

void Set(char (&field)[kLongestName + 1], const std::string& text) {
  std::memset(field, 0, sizeof field);
  std::memcpy(field, text.data(), std::min(text.size(), kLongestName));
}

struct Node {
  std::string node_namespace;
  std::string name;
  std::vector<Guid> readers;
  std::vector<Guid> writers;
};

}  // namespace

class RosParticipant::Announcer {
 public:
  virtual ~Announcer() = default;
  virtual void Write() = 0;

  // REQUIRES of these two: the mutex is held.
  void List(std::size_t node, const Guid& endpoint, std::vector<Guid> Node::*endpoints) {
    if (node == kNoNode) return;
    (nodes.at(node).*endpoints).push_back(endpoint);
    nodes_of[endpoint].push_back(node);
  }
  void Remove(const Guid& endpoint) {
    const auto listed = nodes_of.find(endpoint);
    if (listed == nodes_of.end()) return;
    for (const std::size_t index : listed->second) {
      const auto node = nodes.find(index);
      if (node == nodes.end()) continue;
      std::erase(node->second.readers, endpoint);
      std::erase(node->second.writers, endpoint);
    }
    nodes_of.erase(listed);
  }

  Guid participant{};
  std::mutex mutex;  // guards all below
  std::map<std::size_t, Node> nodes;
  std::size_t next_node = 0;
  std::map<Guid, std::vector<std::size_t>> nodes_of;  // by endpoint
};

namespace {

template <typename Info, typename Base>
class InfoWriter final : public Base {
 public:
  explicit InfoWriter(const RosParticipant& owner)
      : topic_(owner.participant(), kDiscoveryTopic),
        writer_(owner.publisher(), topic_, ToDds(Latched()) << TypeUserData<Info>(owner.distribution())) {}

  void Write() override {
    dds::WireArena arena;
    Info info{};
    Set(info.gid, this->participant);
    auto* out = arena.Fill(info.node_entities_info_seq, this->nodes.size());
    for (const auto& [index, node] : this->nodes) {
      Set(out->node_namespace, node.node_namespace);
      Set(out->node_name, node.name);
      FillGids(out->reader_gid_seq, node.readers, arena);
      FillGids(out->writer_gid_seq, node.writers, arena);
      ++out;
    }
    writer_.write(info);
  }

 private:
  template <typename Sequence>
  static void FillGids(Sequence& sequence, const std::vector<Guid>& guids, dds::WireArena& arena) {
    auto* gid = arena.Fill(sequence, guids.size());
    for (const Guid& guid : guids) Set(*gid++, guid);
  }

  dds::Topic<Info> topic_;
  dds::DataWriter<Info> writer_;
};

}  // namespace

RosParticipant::RosParticipant(const RosNetwork& network, const std::string& enclave)
    : RosParticipant(network, EnclaveOf(network, enclave)) {}

RosParticipant::RosParticipant(const RosNetwork& network, const Enclave& enclave)
    : RosConnection(network.distribution),
      participant_(ConfigOf(network, enclave), dds::Qos() << dds::UserData{"enclave=" + enclave.name + ";"}),
      publisher_(participant_),
      subscriber_(participant_),
      service_publisher_(participant_, ServicePartitions(network)),
      service_subscriber_(participant_, ServicePartitions(network)) {
  if (network.distribution == Distribution::kHumble) {
    announcer_ =
        std::make_unique<InfoWriter<humble_rmw_dds_common_msg_dds__ParticipantEntitiesInfo_, Announcer>>(*this);
  } else {
    announcer_ = std::make_unique<InfoWriter<rmw_dds_common_msg_dds__ParticipantEntitiesInfo_, Announcer>>(*this);
  }
  announcer_->participant = GuidOf(participant_.handle());
}

RosParticipant::~RosParticipant() = default;

void RosParticipant::WatchWriters() {
  const std::lock_guard lock(announcer_->mutex);
  watch_.emplace(participant_);
}

void RosParticipant::WatchKnownWriters() {
  const std::lock_guard lock(announcer_->mutex);
  if (watch_) watch_->LookAgain(participant_);
}

void RosParticipant::WatchDistributions() {
  const std::lock_guard lock(announcer_->mutex);
  watch_->ExpectOneRun(distribution());
}

std::size_t RosParticipant::AddNode(const std::string& node_namespace, const std::string& name) {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->nodes[announcer_->next_node] = {node_namespace, name, {}, {}};
  return announcer_->next_node++;
}

void RosParticipant::RemoveNode(std::size_t node) {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->nodes.erase(node);
}

std::unique_ptr<TopicWriter> RosParticipant::MakeWriter(std::size_t node, const TopicSpec& spec) {
  auto writer = std::make_unique<DdsTopicWriter>(*this, spec);
  AddWriter(node, writer->handle());
  return writer;
}

std::unique_ptr<TopicReader> RosParticipant::MakeReader(std::size_t node, const TopicSpec& spec, Part part,
                                                        std::function<void()> on_arrival) {
  auto reader = std::make_unique<DdsTopicReader>(*this, spec, part, DdsTopicReader::Notices{std::move(on_arrival), {}});
  AddReader(node, reader->handle(), part == Part::kReliableReader);
  return reader;
}

std::unique_ptr<ServiceServer> RosParticipant::MakeService(std::size_t node, const ServiceSpec& spec,
                                                           ServiceServer::Handler handler) {
  auto service = std::make_unique<DdsService>(*this, spec, std::move(handler));
  AddReader(node, service->request_reader());
  AddWriter(node, service->response_writer());
  return service;
}

void RosParticipant::ShareWriter(std::size_t node, const TopicWriter& writer) {
  AddWriter(node, static_cast<const DdsTopicWriter&>(writer).handle());
}

void RosParticipant::AddReader(std::size_t node, dds_entity_t reader, bool accepts_best_effort) {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->List(node, GuidOf(reader), &Node::readers);
  if (watch_) watch_->Expect(reader, accepts_best_effort);
}

void RosParticipant::AddWriter(std::size_t node, dds_entity_t writer) {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->List(node, GuidOf(writer), &Node::writers);
}

void RosParticipant::RemoveEndpoint(dds_entity_t endpoint) {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->Remove(GuidOf(endpoint));
}

void RosParticipant::Announce() {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->Write();
}

std::vector<std::string> RosParticipant::DrainMismatches() {
  std::vector<std::string> reports;
  for (Mismatch& mismatch : DrainMismatchesOfTopics()) reports.push_back(std::move(mismatch.report));
  return reports;
}

std::vector<Mismatch> RosParticipant::DrainMismatchesOfTopics() {
  const std::lock_guard lock(announcer_->mutex);
  return watch_ ? watch_->Drain() : std::vector<Mismatch>();
}

}  // namespace troupe::ros
