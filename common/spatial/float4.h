// Four numbers at a time: the vector extensions of GCC and Clang, which every processor has some instructions for.
#pragma once

#include <cstdint>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

namespace troupe {

using Float4 [[gnu::vector_size(16)]] = float;
using Bits4 [[gnu::vector_size(16)]] = std::int32_t;  // the result of a comparison: all bits of a lane, or none

// Bit i: lane i is true.
inline std::uint32_t BitsOf(const Bits4& lanes) {
#ifdef __SSE__
  return static_cast<std::uint32_t>(_mm_movemask_ps(__m128(lanes)));
#else
  return static_cast<std::uint32_t>((lanes[0] & 1) | (lanes[1] & 2) | (lanes[2] & 4) | (lanes[3] & 8));
#endif
}

}  // namespace troupe
