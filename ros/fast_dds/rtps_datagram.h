// Datagrams of RTPS, as far as a participant is to be kept apart from those of Cyclone DDS. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "ros/fast_dds/call_header.h"

namespace troupe::ros {

// Whether a participant of Cyclone DDS has sent it.
bool IsFromCyclone(std::span<const std::uint8_t> datagram);

// The datagram with a domain tag in the announcement of a participant: Cyclone DDS ignores a participant with another
// tag than its own, and Fast DDS knows no tags. Nothing for a datagram without such an announcement.
std::optional<Bytes> WithDomainTag(std::span<const std::uint8_t> datagram, std::string_view tag);

}  // namespace troupe::ros
