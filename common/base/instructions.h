// Functions that are compiled several times, for kinds of vector instructions of which not every processor has all.
//
// All variants of a function must return the same bits, because robots on different machines compute the same world: no
// fused multiply-add, no reordered sums. Tests run each variant that the machine has.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

// On Windows GCC does not align what it keeps on the stack.
#if defined(__x86_64__) && !defined(_WIN32)
#define TROUPE_HAS_AVX512
#endif

namespace troupe {

// Kinds of instructions; each includes the earlier ones. Elsewhere than on x86-64 there is one, in which the
// compiler divides vectors among the instructions that there are.
enum class Instructions : std::uint8_t { kAny, kAvx2, kAvx512 };  // the last: AVX-512 F and DQ

// The last kind that this processor can run.
Instructions KnownInstructions();

// A function and the instructions that it needs.
template <typename Function>
struct Variant {
  Instructions needs;
  Function* run;
};

// The variants that this processor can run, the quickest last. REQUIRES: the first needs kAny, and all are in the order
// of instructions.
template <typename Function, std::size_t count>
std::span<const Variant<Function>> RunnableOf(const std::array<Variant<Function>, count>& variants) {
  std::size_t runnable = 1;
  while (runnable < count && variants[runnable].needs <= KnownInstructions()) ++runnable;
  return std::span(variants).first(runnable);
}

}  // namespace troupe
