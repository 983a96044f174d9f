#include "transport/shared_memory/shared_layout.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <climits>
#include <cmath>

namespace troupe {
namespace {

// Each robot at most once.
template <typename Row>
bool IsAscending(const std::vector<Row>& rows) {
  const auto is_out_of_order = [](const Row& a, const Row& b) { return a.robot >= b.robot; };
  return std::adjacent_find(rows.begin(), rows.end(), is_out_of_order) == rows.end();
}

}  // namespace

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

std::uint64_t SharedLayout() {
  constexpr std::uint64_t fields = LayoutOf<SharedSession>(LayoutOf<ProposalMessage>(0x54726f7570650009));
  return fields ^ LayoutOfBuild();
}

void AddProposal(const ProposalMessage& message, WordWriter& words) {
  words.Add(message);
}

Status ReadProposal(WordReader words, ProposalMessage& message) {
  if (words.Read(message) && words.remaining() == 0 && IsAscending(message.proposals)) return {};
  return Error{{}, "a proposal in shared memory that is incomplete, or has robots out of order"};
}

}  // namespace troupe
