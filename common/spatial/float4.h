// Four numbers at a time: the vector extensions of GCC and Clang, which every processor has some instructions for.
#pragma once

#include <cstdint>

namespace troupe {

using Float4 [[gnu::vector_size(16)]] = float;
using Bits4 [[gnu::vector_size(16)]] = std::int32_t;  // what a comparison gives: all bits of a lane, or none

inline constexpr Bits4 kLaneBits{1, 2, 4, 8};

// The bits of all lanes together.
inline std::uint32_t AllBits(const Bits4& lanes) {
  return static_cast<std::uint32_t>(lanes[0] | lanes[1] | lanes[2] | lanes[3]);
}

}  // namespace troupe
