// StackMemory: memory for short-lived vectors, on the stack as long as they are small.
//
//   StackMemory memory;
//   std::pmr::vector<BodyId> near(&memory);
#pragma once

#include <array>
#include <cstddef>
#include <memory_resource>

namespace troupe {

namespace internal {
// A base class, so that the bytes outlive the resource that uses them.
struct StackBytes {
  alignas(std::max_align_t) std::array<std::byte, 4096> bytes;
};
}  // namespace internal

// Allocates memory one piece after another, first from the stack and then from the heap. Frees nothing before its
// destruction, so it does not suit a vector that grows and shrinks often. Must outlive its vectors. For one thread.
class StackMemory : private internal::StackBytes, public std::pmr::monotonic_buffer_resource {
 public:
  StackMemory() : std::pmr::monotonic_buffer_resource(bytes.data(), bytes.size()) {}
};

}  // namespace troupe
