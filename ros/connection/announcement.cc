#include "ros/connection/announcement.h"

#include <algorithm>
#include <cstring>

namespace troupe::ros {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kHeaderBytes = 20;
constexpr std::uint8_t kData = 0x15;          // a submessage
constexpr std::uint8_t kLittleEndian = 0x01;  // flags of it
constexpr std::uint8_t kHasInlineQos = 0x02;
constexpr std::array<std::uint8_t, 4> kAnnouncer = {0x00, 0x01, 0x00, 0xc2};  // the writer of announcements
constexpr std::uint16_t kSentinel = 0x0001;                                   // parameters
constexpr std::uint16_t kDiscoveryLocator = 0x0032;
constexpr std::uint32_t kUdpV4 = 1;

std::uint32_t Number(Bytes bytes, std::size_t at, std::size_t size, bool little) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::uint8_t byte = bytes[at + (little ? size - 1 - i : i)];
    number = number << 8 | byte;
  }
  return number;
}

// Calls visit(id, value) for the parameters from `at` on; returns the offset behind their end.
template <typename Visit>
std::size_t ForEachParameter(Bytes bytes, std::size_t at, bool little, const Visit& visit) {
  while (at + 4 <= bytes.size()) {
    const auto id = static_cast<std::uint16_t>(Number(bytes, at, 2, little));
    const std::size_t length = Number(bytes, at + 2, 2, little);
    at += 4;
    if (id == kSentinel || at + length > bytes.size()) break;
    visit(id, bytes.subspan(at, length));
    at += length;
  }
  return at;
}

// The port of the first locator in a submessage of the announcer; 0 without one.
std::uint16_t DiscoveryPortIn(Bytes body, std::uint8_t flags) {
  const bool little = (flags & kLittleEndian) != 0;
  std::size_t at = 4 + Number(body, 2, 2, little);
  if ((flags & kHasInlineQos) != 0) at = ForEachParameter(body, at, little, [](std::uint16_t, Bytes) {});
  if (at + 4 > body.size()) return 0;
  const bool payload_is_little = body[at + 1] == 3;  // PL_CDR_LE
  std::uint16_t port = 0;
  ForEachParameter(body, at + 4, payload_is_little, [&](std::uint16_t id, Bytes value) {
    if (id != kDiscoveryLocator || value.size() < 8 || port != 0) return;
    if (Number(value, 0, 4, payload_is_little) != kUdpV4) return;
    port = static_cast<std::uint16_t>(Number(value, 4, 4, payload_is_little));
  });
  return port;
}

}  // namespace

std::optional<Announcement> ParseAnnouncement(Bytes datagram) {
  if (datagram.size() < kHeaderBytes || std::memcmp(datagram.data(), "RTPS", 4) != 0) return std::nullopt;
  Announcement announcement;
  std::copy_n(datagram.begin() + 8, announcement.prefix.size(), announcement.prefix.begin());
  for (std::size_t at = kHeaderBytes; at + 4 <= datagram.size();) {
    const std::uint8_t id = datagram[at];
    const std::uint8_t flags = datagram[at + 1];
    const std::size_t given = Number(datagram, at + 2, 2, (flags & kLittleEndian) != 0);
    at += 4;
    const std::size_t length = given == 0 ? datagram.size() - at : given;  // 0: to the end
    if (at + length > datagram.size()) return std::nullopt;
    const Bytes body = datagram.subspan(at, length);
    if (id == kData && body.size() >= 20 && std::equal(kAnnouncer.begin(), kAnnouncer.end(), body.begin() + 8)) {
      announcement.discovery_port = DiscoveryPortIn(body, flags);
      return announcement;
    }
    at += length;
  }
  return std::nullopt;
}

}  // namespace troupe::ros
