// StackMemory: for vectors that live for a moment, on the stack as long as they are small.
//
//   StackMemory memory;
//   std::pmr::vector<BodyId> near(&memory);
#pragma once

#include <array>
#include <cstddef>
#include <memory_resource>

namespace troupe {

namespace internal {
struct StackBytes {
  alignas(std::max_align_t) std::array<std::byte, 4096> bytes;
};
}  // namespace internal

// What is freed is not used again before the end.
class StackMemory : private internal::StackBytes, public std::pmr::monotonic_buffer_resource {
 public:
  StackMemory() : std::pmr::monotonic_buffer_resource(bytes.data(), bytes.size()) {}
};

}  // namespace troupe
