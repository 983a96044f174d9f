// ApartTransport: a transport of Fast DDS by which a participant and those of Cyclone DDS do not discover each other. A
// client on Cyclone calls the services themselves, and cannot read the responses of this one. It passes on only the
// parts of a datagram that are safe to read.
#pragma once

#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <memory>

namespace troupe::ros {

// `low_level`: the transport that sends and receives.
std::shared_ptr<eprosima::fastdds::rtps::ChainingTransportDescriptor> ApartFromCyclone(
    const std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>& low_level);

}  // namespace troupe::ros
