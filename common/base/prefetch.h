// Prefetch: has a processor fetch memory that is used soon. For the objects of a swarm, which are more than a cache has
// room for: each first read would else wait for the memory.
#pragma once

#include <cstddef>

namespace troupe {

// All lines of a cache with these bytes, which may be changed. Any address is valid.
inline void Prefetch(const void* begin, std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  for (std::size_t i = 0; i < bytes; i += kLine) __builtin_prefetch(static_cast<const std::byte*>(begin) + i, 1);
}

}  // namespace troupe
