#include "ros/connection/writer_watch.h"

#include <fmt/format.h>

#include <cstring>
#include <string_view>

#include "ros/connection/type_hash.h"
#include "transport/dds/binding/exception.h"

namespace troupe::ros {
namespace {

constexpr std::string_view kNodesTopic = "ros_discovery_info";
constexpr std::string_view kClockTopic = "rt/clock";
constexpr std::size_t kBatch = 64;
constexpr std::size_t kMostReports = 100;  // a hostile peer can make up any number

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

WriterWatch::WriterWatch(const dds::DomainParticipant& participant) {
  dds::Check(dds_get_guid(participant.handle(), &self_), "reading a participant's GUID");
  LookAgain(participant);
}

// A new reader has them all.
void WriterWatch::LookAgain(const dds::DomainParticipant& participant) {
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
      is_humble ? "Humble" : "Iron or later", ToString(own));
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
  if (problem.empty() || reported_.size() >= kMostReports) return std::nullopt;
  const bool is_new = reported_.emplace(found->first, problem).second;
  if (!is_new) return std::nullopt;
  return fmt::format("{}: cannot read another program's publisher: {}", ShownTopic(found->first), problem);
}

}  // namespace troupe::ros
