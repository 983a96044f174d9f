// Datagrams of RTPS, as far as a participant is to be kept apart from those of Cyclone DDS, and from datagrams that
// Fast DDS 2.9 cannot read without harm. Pure functions.
// Every datagram of the network passes through here before Fast DDS sees it, so all input is hostile: lengths are
// checked before each read.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "ros/connection/ros_connection.h"

namespace troupe::ros {

// The header that rmw_cyclonedds puts before a request and its response: the id of the client and the number of its
// call, 8 bytes each, after the 4 bytes that state the encoding. Pure functions on serialized samples.

using Bytes = std::vector<std::uint8_t>;

// Whether a sample is in the encoding of ROS, of either byte order.
bool IsPlainCdr(std::span<const std::uint8_t> sample);

// Nothing for a sample that is not plain CDR.
std::optional<Bytes> WithHeader(std::span<const std::uint8_t> sample, const CallHeader& header);

struct HeadedSample {
  CallHeader header;
  Bytes sample;  // without the header
};
// Splits such a sample; nothing for one that is too short.
std::optional<HeadedSample> SplitHeader(std::span<const std::uint8_t> sample);

// Whether a participant of Cyclone DDS has sent it.
bool IsFromCyclone(std::span<const std::uint8_t> datagram);

// The parts of a datagram that Fast DDS may read; nothing if there are none. Fast DDS 2.9 ends the process by an
// assertion at a submessage of its statistics (0x80) that it does not expect and at a heartbeat from sequence number 0,
// reads beyond buffers at lengths that overflow, and counts gaps one by one. So submessages and parameters that serve
// no ROS client are left out, and a datagram of which one of the others does not have the lengths and ranges of RTPS is
// dropped.
std::optional<Bytes> SafeParts(std::span<const std::uint8_t> datagram);

// The datagram with a domain tag in the announcement of a participant: Cyclone DDS ignores a participant with another
// tag than its own, and Fast DDS knows no tags. Nothing for a datagram without such an announcement.
std::optional<Bytes> WithDomainTag(std::span<const std::uint8_t> datagram, std::string_view tag);

}  // namespace troupe::ros
