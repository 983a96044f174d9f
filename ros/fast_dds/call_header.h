// The header that rmw_cyclonedds puts before a request and its response: the id of the client and the number of its
// call, 8 bytes each, after the 4 bytes that state the encoding. Pure functions on serialized samples.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ros/connection/ros_connection.h"

namespace troupe::ros {

using Bytes = std::vector<std::uint8_t>;

// Whether a sample is in the encoding of ROS, of either byte order.
bool IsPlainCdr(std::span<const std::uint8_t> sample);

// Nothing for a sample that is not plain CDR.
std::optional<Bytes> WithHeader(std::span<const std::uint8_t> sample, const CallHeader& header);

struct HeadedSample {
  CallHeader header;
  Bytes sample;  // without the header
};
// Likewise, and nothing for a sample that is too short.
std::optional<HeadedSample> SplitHeader(std::span<const std::uint8_t> sample);

}  // namespace troupe::ros
