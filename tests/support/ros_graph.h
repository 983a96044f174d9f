// RosGraph: the nodes and topics of a ROS domain, as tools of ROS list them.
// It reads ros_discovery_info and the built-in topics of DDS, as `ros2 node list` does, so that no installation of ROS
// is needed.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "ros/connection/ros_network.h"
#include "ros/connection/ros_participant.h"
#include "ros/connection/topic_types.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/wire.h"

namespace troupe::test {

class RosGraph {
 public:
  explicit RosGraph(const ros::RosNetwork& options = TestRosNetwork(), const std::string& enclave = "/")
      : participant_(options, enclave) {}

  // "/r0/robot": the nodes of all participants that are there, one that two of them announce twice.
  std::vector<std::string> Nodes() {
    ReadInfos();
    std::set<Guid> present;
    ForEachAlive<dds_builtintopic_participant_t>(participants_, [&](const dds_builtintopic_participant_t& participant) {
      present.insert(GuidOf(participant.key.v));
    });
    std::vector<std::string> all;
    for (const auto& [guid, nodes] : nodes_) {
      if (!present.contains(guid)) continue;
      for (const Node& node : nodes) all.push_back(node.name);
    }
    std::sort(all.begin(), all.end());
    return all;
  }
  bool HasNode(const std::string& name) {
    const std::vector<std::string> nodes = Nodes();
    return std::find(nodes.begin(), nodes.end(), name) != nodes.end();
  }
  // Without that of this object.
  std::size_t Participants() {
    std::size_t count = 0;
    ForEachAlive<dds_builtintopic_participant_t>(participants_,
                                                 [&count](const dds_builtintopic_participant_t&) { ++count; });
    return count - 1;
  }
  // How many writers are listed as those of the node.
  std::size_t WritersOf(const std::string& name) {
    ReadInfos();
    for (const auto& [guid, nodes] : nodes_) {
      for (const Node& node : nodes) {
        if (node.name == name) return node.writers;
      }
    }
    return 0;
  }

  // "/r0/odom": the topics below `prefix` that have a writer.
  std::set<std::string> Topics(const std::string& prefix) {
    std::set<std::string> topics;
    ForEachAlive<dds_builtintopic_endpoint_t>(publications_, [&](const dds_builtintopic_endpoint_t& writer) {
      const std::string name = writer.topic_name;
      if (name.starts_with("rt" + prefix)) topics.insert(name.substr(2));
    });
    return topics;
  }

  // The user data of all readers and writers of other participants, by topic: "rt/r0/odom".
  std::multimap<std::string, std::string> UserData() {
    std::multimap<std::string, std::string> found;
    dds_guid_t self{};
    dds::Check(dds_get_guid(participant_.participant().handle(), &self), "reading the graph");
    for (const dds::Entity* endpoints : {&publications_, &subscriptions_}) {
      ForEachAlive<dds_builtintopic_endpoint_t>(*endpoints, [&](const dds_builtintopic_endpoint_t& endpoint) {
        if (GuidOf(endpoint.participant_key.v) == GuidOf(self.v)) return;
        void* bytes = nullptr;
        std::size_t size = 0;
        if (!dds_qget_userdata(endpoint.qos, &bytes, &size)) size = 0;
        found.emplace(endpoint.topic_name, std::string(static_cast<const char*>(bytes), size));
        dds_free(bytes);
      });
    }
    return found;
  }

 private:
  using Info = rmw_dds_common_msg_dds__ParticipantEntitiesInfo_;
  using Guid = std::array<std::uint8_t, 16>;
  struct Node {
    std::string name;
    std::size_t writers;
  };
  static constexpr std::uint32_t kMaxSamples = 10000;

  template <typename Byte>
  static Guid GuidOf(const Byte (&bytes)[16]) {
    Guid guid;
    std::copy(std::begin(bytes), std::end(bytes), guid.begin());
    return guid;
  }

  void ReadInfos() {
    for (;;) {
      const dds::LoanedSamples<Info> samples = infos_.take();
      if (samples.empty()) return;
      for (const auto sample : samples) {
        if (!sample.info().valid()) continue;
        std::vector<Node>& nodes = nodes_[GuidOf(sample.data().gid.data)];
        nodes.clear();
        for (const auto& node : dds::Elements(sample.data().node_entities_info_seq)) {
          const std::string space = node.node_namespace;
          nodes.push_back({(space == "/" ? "" : space) + "/" + node.node_name, node.writer_gid_seq._length});
        }
      }
    }
  }

  dds::Entity BuiltinReader(dds_entity_t topic) const {
    return dds::Entity(dds::Check(dds_create_reader(participant_.participant().handle(), topic, nullptr, nullptr),
                                  "reading the graph"));
  }
  template <typename Sample, typename Visit>
  static void ForEachAlive(const dds::Entity& reader, const Visit& visit) {
    std::vector<void*> samples(kMaxSamples, nullptr);
    std::vector<dds_sample_info_t> infos(kMaxSamples);
    const dds_return_t count = dds::Check(dds_read_mask(reader.handle(), samples.data(), infos.data(), kMaxSamples,
                                                        kMaxSamples, DDS_ALIVE_INSTANCE_STATE),
                                          "reading");
    for (dds_return_t i = 0; i < count; ++i) {
      const auto index = static_cast<std::size_t>(i);
      if (infos[index].valid_data) visit(*static_cast<const Sample*>(samples[index]));
    }
    if (count > 0) dds::Check(dds_return_loan(reader.handle(), samples.data(), count), "returning samples");
  }

  ros::RosParticipant participant_;
  dds::Topic<Info> topic_{participant_.participant(), "ros_discovery_info"};
  dds::DataReader<Info> infos_{participant_.subscriber(), topic_, ros::ToDds(ros::Latched(1000))};
  dds::Entity participants_ = BuiltinReader(DDS_BUILTIN_TOPIC_DCPSPARTICIPANT);
  dds::Entity publications_ = BuiltinReader(DDS_BUILTIN_TOPIC_DCPSPUBLICATION);
  dds::Entity subscriptions_ = BuiltinReader(DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION);
  std::map<Guid, std::vector<Node>> nodes_;  // by the participant that announced them
};

}  // namespace troupe::test
