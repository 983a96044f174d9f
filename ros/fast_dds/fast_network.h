// How a participant on Fast DDS discovers others: as those on Cyclone DDS in the ROS domain
// (ros/connection/ros_network.h).
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "ros/messages/ros_options.h"

namespace troupe::ros {

// It and participants on Cyclone DDS do not discover each other. Throws std::runtime_error if the network interface or
// a static peer has no address.
eprosima::fastdds::dds::DomainParticipantQos FastNetwork(const RosNetwork& network);

}  // namespace troupe::ros
