#include "ros/fast_dds/rtps_datagram.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace troupe::ros {
namespace {

// RTPS 2.5, sections 9.4 and 9.6.
constexpr std::size_t kRtpsHeader = 20;
constexpr std::size_t kSubmessageHeader = 4;
constexpr std::uint8_t kData = 0x15;
constexpr std::uint8_t kIsLittleEndian = 0x01;
constexpr std::uint8_t kHasInlineQos = 0x02;
constexpr std::uint8_t kHasPayload = 0x04;
constexpr std::array<std::uint8_t, 4> kAnnouncer = {0x00, 0x01, 0x00, 0xc2};
constexpr std::uint16_t kEndOfParameters = 0x0001;
constexpr std::uint16_t kDomainTag = 0x4014;

using Datagram = std::span<const std::uint8_t>;

bool IsRtps(Datagram datagram) {
  constexpr std::string_view kMagic = "RTPS";
  return datagram.size() >= kRtpsHeader && std::equal(kMagic.begin(), kMagic.end(), datagram.begin());
}

std::uint16_t ReadShort(Datagram datagram, std::size_t at, bool little_endian) {
  const unsigned first = datagram[at];
  const unsigned second = datagram[at + 1];
  return static_cast<std::uint16_t>(little_endian ? first | second << 8U : first << 8U | second);
}

void WriteNumber(Bytes& bytes, std::uint32_t value, std::size_t size, bool little_endian) {
  for (std::size_t i = 0; i < size; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> 8U * (little_endian ? i : size - 1 - i)));
  }
}

// The parameter, padded to a multiple of 4 bytes.
Bytes TagParameter(std::string_view tag, bool little_endian) {
  const std::size_t text = (tag.size() + 1 + 3) / 4 * 4;
  Bytes bytes;
  WriteNumber(bytes, kDomainTag, 2, little_endian);
  WriteNumber(bytes, static_cast<std::uint32_t>(4 + text), 2, little_endian);
  WriteNumber(bytes, static_cast<std::uint32_t>(tag.size() + 1), 4, little_endian);
  bytes.insert(bytes.end(), tag.begin(), tag.end());
  bytes.resize(8 + text, 0);
  return bytes;
}

// Behind the parameters that begin at `at`.
std::optional<std::size_t> EndOfParameters(Datagram datagram, std::size_t at, bool little_endian) {
  while (at + 4 <= datagram.size()) {
    const std::uint16_t id = ReadShort(datagram, at, little_endian);
    if (id == kEndOfParameters) return at + 4;
    at += 4U + ReadShort(datagram, at + 2, little_endian);
  }
  return std::nullopt;
}

// Where the announcement in the submessage begins, with its encoding; nothing if it is another submessage.
std::optional<std::size_t> FindAnnouncement(Datagram datagram, std::size_t submessage) {
  constexpr std::size_t kWriter = 12;
  const std::uint8_t flags = datagram[submessage + 1];
  const bool little_endian = (flags & kIsLittleEndian) != 0;
  if (datagram[submessage] != kData || (flags & kHasPayload) == 0) return std::nullopt;
  if (submessage + kWriter + kAnnouncer.size() > datagram.size() ||
      !std::equal(kAnnouncer.begin(), kAnnouncer.end(), datagram.begin() + submessage + kWriter)) {
    return std::nullopt;
  }
  std::optional<std::size_t> payload = submessage + 8U + ReadShort(datagram, submessage + 6, little_endian);
  if ((flags & kHasInlineQos) != 0) payload = EndOfParameters(datagram, *payload, little_endian);
  if (!payload || *payload + 4 > datagram.size()) return std::nullopt;
  return payload;
}

}  // namespace

bool IsFromCyclone(Datagram datagram) {
  return IsRtps(datagram) && datagram[6] == 0x01 && datagram[7] == 0x10;
}

std::optional<Bytes> WithDomainTag(Datagram datagram, std::string_view tag) {
  if (!IsRtps(datagram)) return std::nullopt;
  std::size_t submessage = kRtpsHeader;
  while (submessage + kSubmessageHeader <= datagram.size()) {
    const bool little_endian = (datagram[submessage + 1] & kIsLittleEndian) != 0;
    const std::uint16_t length = ReadShort(datagram, submessage + 2, little_endian);
    if (const auto announcement = FindAnnouncement(datagram, submessage)) {
      const std::size_t parameters = *announcement + 4;
      const Bytes added = TagParameter(tag, datagram[*announcement + 1] == 3);
      Bytes tagged(datagram.begin(), datagram.begin() + static_cast<std::ptrdiff_t>(parameters));
      tagged.insert(tagged.end(), added.begin(), added.end());
      tagged.insert(tagged.end(), datagram.begin() + static_cast<std::ptrdiff_t>(parameters), datagram.end());
      if (length != 0) {  // 0: to the end of the datagram
        Bytes field;
        WriteNumber(field, static_cast<std::uint32_t>(length + added.size()), 2, little_endian);
        std::copy(field.begin(), field.end(), tagged.begin() + static_cast<std::ptrdiff_t>(submessage + 2));
      }
      return tagged;
    }
    if (length == 0) return std::nullopt;
    submessage += kSubmessageHeader + length;
  }
  return std::nullopt;
}

}  // namespace troupe::ros
