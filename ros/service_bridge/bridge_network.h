// How the participants of a bridge discover others: as Troupe's own in the ROS domain (ros/connection/ros_network.h).
#pragma once

#include <cstdint>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "ros/messages/ros_options.h"

namespace troupe::ros {

// With which programs a participant of a bridge speaks.
enum class BridgeSide : std::uint8_t { kClients, kRun };

// The participant of clients and those of Cyclone DDS do not discover each other. Throws std::runtime_error if the
// network interface or a static peer has no address.
eprosima::fastdds::dds::DomainParticipantQos BridgeNetwork(const RosOptions& options, BridgeSide side);

}  // namespace troupe::ros
