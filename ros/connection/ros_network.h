// How participants in a ROS domain discover each other. With each range of discovery, tools on rmw_cyclonedds_cpp and
// rmw_fastrtps_cpp of the chosen distribution discover these participants. docs/ros2.md explains it.
#pragma once

#include "ros/messages/ros_options.h"
#include "transport/dds/binding/domain_config.h"

namespace troupe::ros {

// Throws dds::Exception if a static peer has no address.
dds::DomainConfig NetworkConfig(const RosNetwork& network);

// Whether participants of this machine announce themselves on its loopback interface.
bool AnnouncesOnLoopback(const RosNetwork& network);

// Whether participants use no interface but the loopback one. In the range `localhost` those of Humble do; from Iron on
// they listen on the usual interface too, and Fast DDS announces its address, not that of the loopback interface.
bool UsesLoopbackOnly(const RosNetwork& network);

// At the ports of how many participant indices the tools of a distribution look for others on a machine.
std::uint32_t IndicesSearched(Distribution distribution);

}  // namespace troupe::ros
