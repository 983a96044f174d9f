// The CRC-32 of MCAP files: that of zlib and PNG.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace troupe::mcap {

// `crc`: of the bytes before.
std::uint32_t Crc32(std::span<const std::byte> bytes, std::uint32_t crc = 0);

}  // namespace troupe::mcap
