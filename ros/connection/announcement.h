// Announcement: the announcement of a DDS participant (SPDP), as far as a relay of announcements needs it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace troupe::ros {

struct Announcement {
  std::array<std::uint8_t, 12> prefix{};  // of the participant's GUIDs
  std::uint16_t discovery_port = 0;       // UDP over IPv4; 0: the end of the participant, or none is given
};

// Of a datagram; nothing if it has none.
std::optional<Announcement> ParseAnnouncement(std::span<const std::uint8_t> datagram);

}  // namespace troupe::ros
