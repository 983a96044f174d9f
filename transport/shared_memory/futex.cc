#include "transport/shared_memory/futex.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <climits>
#include <cmath>

namespace troupe {

void FutexWait(const FutexWord& word, std::uint32_t value, double seconds, std::uint32_t groups) {
  // FUTEX_WAIT_BITSET expects an instant, not a duration.
  timespec until{};
  clock_gettime(CLOCK_MONOTONIC, &until);
  const double whole = std::floor(seconds);
  until.tv_sec += static_cast<time_t>(whole);
  until.tv_nsec += static_cast<long>((seconds - whole) * 1e9);
  if (until.tv_nsec >= 1'000'000'000) {
    until.tv_nsec -= 1'000'000'000;
    ++until.tv_sec;
  }
  syscall(SYS_futex, &word, FUTEX_WAIT_BITSET, value, &until, nullptr, groups);
}

void FutexWake(const FutexWord& word, std::uint32_t groups) {
  syscall(SYS_futex, &word, FUTEX_WAKE_BITSET, INT_MAX, nullptr, nullptr, groups);
}

}  // namespace troupe
