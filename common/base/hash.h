// Hasher: a 64-bit hash of values by their bits, the same on every machine. It compares worlds and states of processes
// and keys random numbers (troupe/random.h), so that its results are a part of formats and must never change. Not for
// untrusted keys: collisions can be made on purpose.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

namespace troupe {

class Hasher {
 public:
  // Mixes one 64-bit word in (the finalizer of SplitMix64: Steele, Lea, Flood 2014).
  void Add(std::uint64_t word) {
    state_ = (state_ ^ word) * 0x9e3779b97f4a7c15u;
    state_ ^= state_ >> 30;
    state_ *= 0xbf58476d1ce4e5b9u;
    state_ ^= state_ >> 27;
    state_ *= 0x94d049bb133111ebu;
    state_ ^= state_ >> 31;
  }
  // Both zeros hash alike, because both mean the same pose.
  void Add(double value) { Add(std::bit_cast<std::uint64_t>(value == 0.0 ? 0.0 : value)); }
  void Add(std::string_view text) {
    Add(static_cast<std::uint64_t>(text.size()));
    for (unsigned char c : text) Add(static_cast<std::uint64_t>(c));
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0x6a09e667f3bcc908u;
};

// FindEqualMemory: large data that several processes compute alike, each for itself, can be held once for all of them.
// Memory with the same bytes that this process shares with others and that never changes, or null. A process that uses
// it instead of its own saves the memory, and finds it in the caches that the others have filled.
using FindEqualMemory = std::function<std::shared_ptr<const std::byte>(std::span<const std::byte> bytes)>;

}  // namespace troupe
