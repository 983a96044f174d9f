#include "common/ros_dds/ros_participant.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <random>
#include <utility>
#include <variant>

#include "common/dds/binding/data_writer.h"
#include "common/dds/binding/domain_config.h"
#include "common/dds/binding/wire.h"
#include "common/ros_dds/ros_network.h"
#include "common/ros_dds/ros_qos.h"
#include "common/ros_dds/topic_types.h"
#include "common/ros_dds/user_data.h"

namespace troupe::ros {
namespace {

constexpr const char* kDiscoveryTopic = "ros_discovery_info";
constexpr std::size_t kLongestName = 256;

Enclave EnclaveOf(const RosOptions& options, const std::string& name) {
  Result<Enclave> enclave = FindEnclave(options.security, name);
  if (!enclave.ok()) throw dds::Exception(DDS_RETCODE_BAD_PARAMETER, "starting ROS: " + enclave.error().ToString());
  return std::move(enclave).value();
}

dds::DomainConfig ConfigOf(const RosOptions& options, const Enclave& enclave) {
  dds::DomainConfig config = RosNetwork(options);
  config.security_enclave = enclave.folder;
  config.numbered_as_on_network = !enclave.folder.empty();  // permissions of ROS name its domain
  return config;
}

// Clients on Cyclone DDS are in no partition: for Cyclone they match "*", but not for Fast DDS, whose clients would
// send requests here that have no number of the call; so these discover the bridge alone.
dds::Qos ServicePartitions(const RosOptions& options) {
  dds::Qos qos;
  if (!UsesBridge(options)) return qos;
  dds::Partitions partitions = {{BridgePartition(options.session)}};
  if (options.service_clients == ServiceClients::kBoth) partitions.names.emplace_back("*");
  return qos << partitions;
}

dds_guid_t GuidOf(dds_entity_t entity) {
  dds_guid_t guid{};
  dds::Check(dds_get_guid(entity, &guid), "reading an entity's GUID");
  return guid;
}

// The GUID, followed by zeros where the field of the distribution is longer.
template <typename Gid>
void Set(Gid& gid, const dds_guid_t& guid) {
  std::memset(gid.data, 0, sizeof gid.data);
  std::memcpy(gid.data, guid.v, sizeof guid.v);
}

void Set(char (&field)[kLongestName + 1], const std::string& text) {
  std::memset(field, 0, sizeof field);
  std::memcpy(field, text.data(), std::min(text.size(), kLongestName));
}

struct Node {
  std::string node_namespace;
  std::string name;
  std::vector<dds_guid_t> readers;
  std::vector<dds_guid_t> writers;
};

}  // namespace

class RosParticipant::Announcer {
 public:
  virtual ~Announcer() = default;
  virtual void Write() = 0;

  dds_guid_t participant{};
  std::mutex mutex;  // guards the nodes
  std::vector<Node> nodes;
};

namespace {

template <typename Info, typename Base>
class InfoWriter final : public Base {
 public:
  explicit InfoWriter(const RosParticipant& owner)
      : topic_(owner.participant(), kDiscoveryTopic),
        writer_(owner.publisher(), topic_, Discovery() << TypeUserData<Info>(owner.distribution())) {}

  void Write() override {
    dds::WireArena arena;
    Info info{};
    Set(info.gid, this->participant);
    auto* out = arena.Fill(info.node_entities_info_seq, this->nodes.size());
    for (const Node& node : this->nodes) {
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
  static void FillGids(Sequence& sequence, const std::vector<dds_guid_t>& guids, dds::WireArena& arena) {
    auto* gid = arena.Fill(sequence, guids.size());
    for (const dds_guid_t& guid : guids) Set(*gid++, guid);
  }

  dds::Topic<Info> topic_;
  dds::DataWriter<Info> writer_;
};

}  // namespace

RosParticipant::RosParticipant(const RosOptions& options, const std::string& enclave)
    : RosParticipant(options, EnclaveOf(options, enclave)) {}

RosParticipant::RosParticipant(const RosOptions& options, const Enclave& enclave)
    : distribution_(options.distribution),
      participant_(ConfigOf(options, enclave), dds::Qos() << dds::UserData{"enclave=" + enclave.name + ";"}),
      publisher_(participant_),
      subscriber_(participant_),
      service_publisher_(participant_, ServicePartitions(options)),
      service_subscriber_(participant_, ServicePartitions(options)) {
  if (distribution_ == Distribution::kHumble) {
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

void RosParticipant::WatchDistributions() {
  const std::lock_guard lock(announcer_->mutex);
  watch_->ExpectDistribution(distribution_);
}

std::size_t RosParticipant::AddNode(const std::string& node_namespace, const std::string& name) {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->nodes.push_back({node_namespace, name, {}, {}});
  return announcer_->nodes.size() - 1;
}

void RosParticipant::AddReader(std::size_t node, dds_entity_t reader, bool accepts_best_effort) {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->nodes[node].readers.push_back(GuidOf(reader));
  if (watch_) watch_->Expect(reader, accepts_best_effort);
}

void RosParticipant::AddWriter(std::size_t node, dds_entity_t writer) {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->nodes[node].writers.push_back(GuidOf(writer));
}

void RosParticipant::Announce() {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->Write();
}

std::vector<std::string> RosParticipant::DrainMismatches() {
  const std::lock_guard lock(announcer_->mutex);
  return watch_ ? watch_->DrainReports() : std::vector<std::string>();
}

bool HasReaderOf(dds_entity_t writer, dds_entity_t reader, dds_instance_handle_t publication) {
  dds_builtintopic_endpoint_t* const sender = dds_get_matched_publication_data(reader, publication);
  if (sender == nullptr) return true;  // the caller has left; an answer does no harm
  const dds_guid_t participant = sender->participant_key;
  dds_builtintopic_free_endpoint(sender);
  std::vector<dds_instance_handle_t> subscriptions(64);
  dds_return_t count = 0;
  for (;;) {
    count = dds_get_matched_subscriptions(writer, subscriptions.data(), subscriptions.size());
    if (count <= static_cast<dds_return_t>(subscriptions.size())) break;
    subscriptions.resize(static_cast<std::size_t>(count));
  }
  for (dds_return_t i = 0; i < count; ++i) {
    dds_builtintopic_endpoint_t* const receiver =
        dds_get_matched_subscription_data(writer, subscriptions[static_cast<std::size_t>(i)]);
    if (receiver == nullptr) continue;
    const bool same = std::memcmp(receiver->participant_key.v, participant.v, sizeof participant.v) == 0;
    dds_builtintopic_free_endpoint(receiver);
    if (same) return true;
  }
  return false;
}

std::string NewServiceId() {
  std::random_device device;
  std::string id;
  for (int i = 0; i < 16; ++i) {
    char byte[4];
    std::snprintf(byte, sizeof byte, "%s%02x", i == 0 ? "" : ".", static_cast<unsigned>(device() & 0xffU));
    id += byte;
  }
  return id;
}

RosNode MakeNode(RosParticipant& participant, const std::string& node_namespace, const std::string& name) {
  return {&participant, participant.AddNode(node_namespace, name), node_namespace};
}

}  // namespace troupe::ros
