// How participants in ROS use the network: the configuration of Cyclone DDS, and the QoS of topics and services. All in
// one place, because a reader and a writer with QoS that do not fit never meet, and neither is told.
//
// The QoS of topics are those of ROS 2's own nodes (streams keep the last samples, latched topics keep the last one for
// late readers), so that tools and Nav2 match without settings of their own.
#pragma once

#include <cstdint>
#include <tuple>

#include "ros/messages/ros_options.h"
#include "transport/dds/binding/domain_config.h"
#include "transport/dds/binding/qos.h"
#include "troupe/fields.h"

namespace troupe::ros {

// How participants in a ROS domain discover each other. With each range of discovery, tools on rmw_cyclonedds_cpp and
// rmw_fastrtps_cpp of the chosen distribution discover these participants. docs/ros2.md explains it.

// Throws dds::Exception if a static peer has no address.
dds::DomainConfig NetworkConfig(const RosNetwork& network);

// Whether participants of this machine announce themselves on its loopback interface.
bool AnnouncesOnLoopback(const RosNetwork& network);

// Whether participants use no interface but the loopback one. In the range `localhost` participants of Humble do; from
// Iron on they listen on the usual interface too, and Fast DDS announces its address, not that of the loopback
// interface.
bool UsesLoopbackOnly(const RosNetwork& network);

// At the ports of how many participant indices the tools of a distribution look for others on a machine.
std::uint32_t IndicesSearched(Distribution distribution);

// The QoS of ROS topics: it matches the readers of ROS tools and keeps a slow reader from delaying a tick.
// docs/ros2.md has the table.

struct TopicQos {
  enum class Kind : std::uint8_t { kStream, kLatched, kReliableCommands, kBestEffortCommands, kLogLines };
  Kind kind = Kind::kStream;
  std::int32_t depth = 1;  // samples that are kept for a slow reader

  static constexpr auto Fields() {
    return std::tuple{
        Field{"kind", &TopicQos::kind},
        Field{"depth", &TopicQos::depth},
    };
  }
};

dds::Qos ToDds(const TopicQos& qos);

// Reliable, because a reliable writer matches both kinds of readers; volatile. A slow reader receives the latest
// `depth` samples.
TopicQos Stream(std::int32_t depth);
// Reliable and kept for late readers: maps, static transforms, descriptions, the announcement of nodes.
TopicQos Latched(std::int32_t depth = 1);
// The latest command. A reliable reader matches only reliable writers, whose samples arrive even if they are sent
// before the reader has discovered the writer; these can wait for its acknowledgment. A best-effort one matches every
// writer.
TopicQos Commands(bool reliable, std::int32_t depth = 1);
// The QoS of services and their clients. All clients of a service get all responses, those to others too. So with few
// samples a response that is lost on the way could not be sent again, and one that a client has not read yet would be
// replaced, as soon as others call.
TopicQos Service(std::int32_t depth = 1000);
// The QoS of /rosout: the lines of the last 10 s, for late readers, too.
TopicQos LogLines();

}  // namespace troupe::ros
