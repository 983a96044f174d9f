// recording/mcap/bytes.h without libraries: chunks that are not compressed, as `troupe view --static` writes them.
#include <array>

#include "recording/mcap/bytes.h"

namespace troupe::mcap {
namespace {

// CRC-32 of IEEE 802.3, as of zlib, by a table of bytes.
constexpr std::array<std::uint32_t, 256> kCrcOfByte = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
    table[byte] = crc;
  }
  return table;
}();

}  // namespace

std::uint32_t Crc32(std::span<const std::byte> bytes, std::uint32_t crc) {
  crc = ~crc;
  for (const std::byte byte : bytes) {
    crc = (crc >> 8) ^ kCrcOfByte[(crc ^ std::to_integer<std::uint32_t>(byte)) & 0xffu];
  }
  return ~crc;
}

Result<std::vector<std::byte>> Decompress(std::span<const std::byte> /*from*/, std::uint64_t /*size*/) {
  return Error{{}, "found a compressed chunk, expected one that troupe view --static has written"};
}

}  // namespace troupe::mcap
