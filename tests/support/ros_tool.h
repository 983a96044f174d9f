// RosTool: a plain participant of Cyclone DDS, configured with the XML that rmw_cyclonedds_cpp of a distribution makes
// from the environment, and the topics that it discovers.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "transport/dds/binding/entity.h"

namespace troupe::test {

// The settings of Humble with ROS_LOCALHOST_ONLY=1.
inline constexpr const char* kHumbleLocalhost =
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/>"
    "</Interfaces></General></Domain></CycloneDDS>,";
// The settings of Jazzy with ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST.
inline constexpr const char* kJazzyLocalhost =
    "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    "<Peers><Peer address=\"localhost\"/></Peers></Discovery></Domain></CycloneDDS>,";
// The settings of Jazzy with ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET, on a network without multicast.
inline constexpr const char* kJazzySubnetWithoutMulticast =
    "<CycloneDDS><Domain><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex></Discovery></Domain></CycloneDDS>,"
    "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General></Domain></CycloneDDS>";

class RosTool {
 public:
  RosTool(std::uint32_t domain, const char* xml)
      : domain_(dds::Check(dds_create_domain(domain, xml), "creating the domain of a tool")),
        participant_(dds::Check(dds_create_participant(domain, nullptr, nullptr), "creating a tool")),
        publications_(
            dds::Check(dds_create_reader(participant_.handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
                       "reading the graph")) {}

  dds_entity_t participant() const { return participant_.handle(); }

  // "/r0/odom": the topics with a writer.
  std::set<std::string> Topics() {
    constexpr std::uint32_t kMax = 10000;
    std::vector<void*> samples(kMax, nullptr);
    std::vector<dds_sample_info_t> infos(kMax);
    std::set<std::string> topics;
    const dds_return_t count = dds::Check(
        dds_read_mask(publications_.handle(), samples.data(), infos.data(), kMax, kMax, DDS_ALIVE_INSTANCE_STATE),
        "reading the graph");
    for (dds_return_t i = 0; i < count; ++i) {
      const auto index = static_cast<std::size_t>(i);
      if (!infos[index].valid_data) continue;
      const std::string name = static_cast<const dds_builtintopic_endpoint_t*>(samples[index])->topic_name;
      if (name.starts_with("rt/")) topics.insert(name.substr(2));
    }
    if (count > 0) dds::Check(dds_return_loan(publications_.handle(), samples.data(), count), "returning samples");
    return topics;
  }

 private:
  dds::Entity domain_;
  dds::Entity participant_;
  dds::Entity publications_;
};

}  // namespace troupe::test
