#include "recording/mcap/crc32.h"

#include <zlib.h>

namespace troupe::mcap {

std::uint32_t Crc32(std::span<const std::byte> bytes, std::uint32_t crc) {
  return static_cast<std::uint32_t>(crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace troupe::mcap
