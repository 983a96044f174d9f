// Futex: waiting for a change of a word that several processes share.
#pragma once

#include <atomic>
#include <cstdint>

namespace troupe {

using FutexWord = std::atomic<std::uint32_t>;
static_assert(sizeof(FutexWord) == sizeof(std::uint32_t) && FutexWord::is_always_lock_free);

inline constexpr std::uint32_t kAllWaiters = ~std::uint32_t{0};

// Returns when the word is not `value`, when a thread of any process wakes one of the `groups` (bits) of this waiter,
// after `seconds`, or earlier. The memory may be read-only.
void FutexWait(const FutexWord& word, std::uint32_t value, double seconds, std::uint32_t groups = kAllWaiters);

// Wakes all that wait for the word in one of these groups.
void FutexWake(const FutexWord& word, std::uint32_t groups = kAllWaiters);

}  // namespace troupe
