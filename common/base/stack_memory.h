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
// A base, so that the bytes are there before the resource begins to use them, and until it has ended.
struct StackBytes {
  alignas(std::max_align_t) std::array<std::byte, 4096> bytes;
};
}  // namespace internal

// Gives out memory one piece after another, first from the stack and then from the heap. Takes nothing back before it
// ends, so a vector that grows and shrinks all the time does not belong here. Must outlive its vectors.
class StackMemory : private internal::StackBytes, public std::pmr::monotonic_buffer_resource {
 public:
  StackMemory() : std::pmr::monotonic_buffer_resource(bytes.data(), bytes.size()) {}
};

}  // namespace troupe
