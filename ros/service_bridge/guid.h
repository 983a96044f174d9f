// Guid: the identity of a DDS endpoint on the network, without a DDS implementation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace troupe::ros {

using Guid = std::array<std::uint8_t, 16>;

// The first two bytes name the implementation. An endpoint of Cyclone DDS: a client with this RMW calls the services
// themselves.
inline bool IsOfCyclone(const Guid& guid) {
  return guid[0] == 0x01 && guid[1] == 0x10;
}

// A reader, not a writer (RTPS 2.2, section 9.3.1.2). The zero Guid is neither.
inline bool IsReader(const Guid& guid) {
  return (guid[15] & 0x04U) != 0;
}

}  // namespace troupe::ros
