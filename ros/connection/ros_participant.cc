#include "ros/connection/ros_participant.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "ros/connection/dds_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"
#include "ros/connection/type_descriptions.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/binding/domain_config.h"
#include "transport/dds/binding/wire.h"

namespace troupe::ros {
namespace {

constexpr const char* kDiscoveryTopic = "ros_discovery_info";
constexpr std::size_t kMaxName = 256;

Enclave EnclaveOf(const RosNetwork& network, const std::string& name) {
  Result<Enclave> enclave = FindEnclave(network.security, name);
  if (!enclave.ok()) throw dds::Exception(DDS_RETCODE_BAD_PARAMETER, "starting ROS: " + enclave.error().ToString());
  return std::move(enclave).value();
}

dds::DomainConfig ConfigOf(const RosNetwork& network, const Enclave& enclave, RosParticipant::Owner owner) {
  dds::DomainConfig config = NetworkConfig(network);
  if (owner == RosParticipant::Owner::kHost) config.linger_seconds = 0.0;
  config.security_enclave = enclave.folder;
  config.numbered_as_on_network = !enclave.folder.empty();  // permissions of ROS name its domain
  return config;
}

// Clients are in no partition: those on Cyclone DDS match "*", and those on Fast DDS, whose requests have no number of
// the call here, do not, up to Fast DDS 2.14.5 and 3.2.2.
dds::Qos ServicePartitions(const RosNetwork& network) {
  return UsesFastDds(network) ? dds::Qos() << dds::Partitions{{"*"}} : dds::Qos();
}

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

void Set(char (&field)[kMaxName + 1], const std::string& text) {
  std::memset(field, 0, sizeof field);
  std::memcpy(field, text.data(), std::min(text.size(), kMaxName));
}

struct Node {
  std::string node_namespace;
  std::string name;
  std::vector<Guid> readers;
  std::vector<Guid> writers;
};

constexpr std::string_view kNodesTopic = "ros_discovery_info";
constexpr std::string_view kClockTopic = "rt/clock";
constexpr std::size_t kBatch = 64;
constexpr std::size_t kMaxReports = 100;  // a hostile peer can make up any number

bool IsReliable(const dds_qos_t* qos) {
  dds_reliability_kind_t kind = DDS_RELIABILITY_BEST_EFFORT;
  dds_duration_t blocking = 0;
  return dds_qget_reliability(qos, &kind, &blocking) && kind == DDS_RELIABILITY_RELIABLE;
}

// From Iron on, endpoints of ROS have one.
bool HasTypeHash(const dds_qos_t* qos) {
  void* bytes = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(qos, &bytes, &size) || bytes == nullptr) return false;
  const bool found =
      std::string_view(static_cast<const char*>(bytes), size).find("typehash=") != std::string_view::npos;
  dds_free(bytes);
  return found;
}

// "geometry_msgs/msg/Twist", or the name on DDS of a type that is not of ROS.
std::string ShownType(const std::string& dds_type) {
  const std::string ros_type = RosTypeName(dds_type);
  return ros_type.empty() ? dds_type : ros_type;
}

// "/anna/cmd_vel" for "rt/anna/cmd_vel".
std::string ShownTopic(const std::string& dds_topic) {
  return dds_topic.starts_with("rt/") ? dds_topic.substr(2) : dds_topic;
}

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

RosParticipant::RosParticipant(const RosNetwork& network, const std::string& enclave, Owner owner)
    : RosParticipant(network, EnclaveOf(network, enclave), owner) {}

RosParticipant::RosParticipant(const RosNetwork& network, const Enclave& enclave, Owner owner)
    : RosConnection(network.distribution),
      participant_(ConfigOf(network, enclave, owner),
                   dds::Qos() << dds::UserData{fmt::format("enclave={};{}", enclave.name,
                                                           owner == Owner::kHost ? kMarkOfRuns : "")}),
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
  // Tools join nodes with endpoints by this GUID.
  announcer_->participant = GuidOf(participant_.handle());
}

RosParticipant::~RosParticipant() = default;

void RosParticipant::WatchWriters() {
  const std::lock_guard lock(announcer_->mutex);
  watch_.emplace(participant_);
}

void RosParticipant::WatchKnownWriters() {
  const std::lock_guard lock(announcer_->mutex);
  if (watch_) watch_->Rediscover(participant_);
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
  auto service = std::make_unique<DdsService>(
      *this, spec,
      [handle = std::move(handler)](const void* request, dds_instance_handle_t) { handle(request, false); });
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

void RosParticipant::AddForeignService(std::size_t node, const Guid& reader, const Guid& writer) {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->List(node, reader, &Node::readers);
  announcer_->List(node, writer, &Node::writers);
}

void RosParticipant::RemoveForeignService(const Guid& reader, const Guid& writer) {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->Remove(reader);
  announcer_->Remove(writer);
}

void RosParticipant::Announce() {
  const std::lock_guard lock(announcer_->mutex);
  announcer_->Write();
}

void RosParticipant::AwaitAcknowledgments(double seconds) const {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  for (const dds::Publisher* publisher : {&publisher_, &service_publisher_}) {
    const auto left = end - std::chrono::steady_clock::now();
    publisher->AwaitAcknowledgments(std::chrono::duration<double>(left).count());
  }
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

WriterWatch::WriterWatch(const dds::DomainParticipant& participant) {
  dds::Check(dds_get_guid(participant.handle(), &self_), "reading a participant's GUID");
  Rediscover(participant);
}

// A new reader delivers all of them.
void WriterWatch::Rediscover(const dds::DomainParticipant& participant) {
  publications_ = dds::Entity(
      dds::Check(dds_create_reader(participant.handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
                 "creating a reader of discovered writers"));
}

void WriterWatch::Expect(dds_entity_t reader, bool accepts_best_effort) {
  const dds_entity_t topic = dds::Check(dds_get_topic(reader), "getting a reader's topic");
  char name[512] = "";
  char type[512] = "";
  dds::Check(dds_get_name(topic, name, sizeof name), "getting a topic's name");
  dds::Check(dds_get_type_name(topic, type, sizeof type), "getting a topic's type");
  dds_qos_t* const qos = dds_create_qos();
  const dds_return_t result = dds_get_qos(reader, qos);
  Expected& expected = expected_[name];
  expected.types.insert(type);
  // Not the reader's policy alone: beside a reliable reader there may be one that takes what best-effort writers send.
  expected.reliable = expected.reliable && !accepts_best_effort && result == DDS_RETCODE_OK && IsReliable(qos);
  dds_delete_qos(qos);
}

std::vector<Mismatch> WriterWatch::Drain() {
  std::vector<Mismatch> found;
  std::uint32_t status = 0;
  if (dds_take_status(publications_.handle(), &status, DDS_DATA_AVAILABLE_STATUS) != DDS_RETCODE_OK || status == 0) {
    return found;
  }
  for (;;) {
    void* samples[kBatch] = {};
    dds_sample_info_t infos[kBatch];
    const dds_return_t count = dds_take(publications_.handle(), samples, infos, kBatch, kBatch);
    if (count <= 0) return found;
    for (dds_return_t i = 0; i < count; ++i) {
      if (!infos[i].valid_data) continue;
      const auto& writer = *static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
      const bool lists_nodes = writer.topic_name == kNodesTopic;
      const bool is_clock = writer.topic_name == kClockTopic;
      std::optional<std::string> report = lists_nodes ? JudgeDistribution(writer)
                                          : is_clock  ? JudgeClock(writer)
                                                      : Judge(writer);
      if (report) found.push_back({lists_nodes || is_clock ? "" : writer.topic_name, *std::move(report)});
    }
    dds_return_loan(publications_.handle(), samples, count);
  }
}

// Once, because every process of the other distribution would be reported.
std::optional<std::string> WriterWatch::JudgeDistribution(const dds_builtintopic_endpoint_t& writer) {
  if (!distribution_) return std::nullopt;
  const bool is_humble = !HasTypeHash(writer.qos);
  if (is_humble == (*distribution_ == Distribution::kHumble)) return std::nullopt;
  const Distribution own = *std::exchange(distribution_, std::nullopt);
  return fmt::format(
      "another program in the ROS domain is of {}, and this run is for {}: they cannot list each other's nodes; "
      "expected "
      "the same with --ros-distro, or another domain",
      is_humble ? "Humble" : "Iron or later", NameOf(own));
}

std::optional<std::string> WriterWatch::JudgeClock(const dds_builtintopic_endpoint_t& writer) {
  const bool is_own = std::memcmp(writer.participant_key.v, self_.v, sizeof self_.v) == 0;
  (is_own ? has_clock_ : has_other_clock_) = true;
  if (!expects_one_clock_ || !has_clock_ || !has_other_clock_) return std::nullopt;
  expects_one_clock_ = false;
  return "another program in the ROS domain writes /clock, as another run does: programs read the times, topics and "
         "answers of both; expected a domain for each run (--ros-domain, ROS_DOMAIN_ID)";
}

std::optional<std::string> WriterWatch::Judge(const dds_builtintopic_endpoint_t& writer) {
  const auto found = expected_.find(writer.topic_name);
  if (found == expected_.end()) return std::nullopt;
  const Expected& expected = found->second;
  std::string problem;
  if (!expected.types.contains(writer.type_name)) {
    std::string types;
    for (const std::string& type : expected.types) types += (types.empty() ? "" : " or ") + ShownType(type);
    problem = fmt::format("its type is {}, expected {}", ShownType(writer.type_name), types);
  } else if (expected.reliable && !IsReliable(writer.qos)) {
    problem = "it is not reliable, expected a reliable one";
  }
  if (problem.empty() || reported_.size() >= kMaxReports) return std::nullopt;
  // Once for each topic and problem: a program that restarts would fill the log.
  const bool is_new = reported_.emplace(found->first, problem).second;
  if (!is_new) return std::nullopt;
  return fmt::format("{}: cannot read another program's publisher: {}", ShownTopic(found->first), problem);
}

}  // namespace troupe::ros
