#include "common/base/thread_pool.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// Bits of a gate: the number of the Run, and below it the places left.
constexpr std::uint32_t kPlacesBits = 12;
constexpr std::uint32_t kPlacesMask = (1u << kPlacesBits) - 1;
constexpr std::size_t kMaxThreads = kPlacesMask;
constexpr std::uint32_t kRoundMask = ~0u >> kPlacesBits;
constexpr std::uint32_t kEnd = 0;  // the number that ends the threads; that of a Run is another one
constexpr std::uint32_t kNoRound = ~0u;

// A thread sleeps after this time without work. It takes longer than the part of a tick that one thread does alone; to
// wake up would take 50 us.
constexpr std::chrono::microseconds kSpin{200};
constexpr int kLooksPerClock = 64;

std::uint32_t Places(std::uint32_t gate) {
  return gate & kPlacesMask;
}

std::uint32_t Round(std::uint32_t gate) {
  return gate >> kPlacesBits;
}

void RelaxProcessor() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

// Waits until the value is another one, for a moment if `spins`, then asleep. Returns it.
std::uint32_t AwaitChange(const std::atomic<std::uint32_t>& value, std::uint32_t from, bool spins) {
  if (spins) {
    for (const auto end = Clock::now() + kSpin; Clock::now() < end;) {
      for (int i = 0; i < kLooksPerClock; ++i) {
        const std::uint32_t now = value.load(std::memory_order_acquire);
        if (now != from) return now;
        RelaxProcessor();
      }
    }
  }
  value.wait(from, std::memory_order_acquire);
  return value.load(std::memory_order_acquire);
}

}  // namespace

ThreadPool::ThreadPool(std::size_t size)
    : size_(std::clamp<std::size_t>(size, 1, kMaxThreads)),
      spins_(size_ <= std::thread::hardware_concurrency()),
      failures_(size_) {}

ThreadPool::~ThreadPool() {
  Open(kEnd, threads_.size());
  for (std::thread& thread : threads_) thread.join();
}

void ThreadPool::Run(std::size_t most, const std::function<void(std::size_t)>& work) {
  const std::size_t places = std::min(most, size_) - 1;
  std::unique_lock lock(running_, std::try_to_lock);
  if (places == 0 || !lock) return work(0);
  StartThreads(places);
  work_ = &work;
  Open(std::max(kEnd + 1, (Round(gate_.load(std::memory_order_relaxed)) + 1) & kRoundMask), places);
  Call(0);
  const std::uint32_t entered = Close();
  for (std::uint32_t left = left_.load(std::memory_order_acquire); left != entered;) {
    left = AwaitChange(left_, left, spins_);
  }
  std::exception_ptr first;
  for (std::exception_ptr& failure : failures_) {
    std::exception_ptr of_call = std::exchange(failure, nullptr);  // also of the others: they are not of the next Run
    if (!first) first = std::move(of_call);
  }
  if (first) std::rethrow_exception(first);
}

// Fewer threads if the system refuses more.
void ThreadPool::StartThreads(std::size_t count) {
  try {
    while (threads_.size() < count) threads_.emplace_back([this] { Serve(); });
  } catch (const std::system_error&) {
  }
}

void ThreadPool::Open(std::uint32_t round, std::size_t places) {
  left_.store(0, std::memory_order_relaxed);
  opened_ = static_cast<std::uint32_t>(places);
  gate_.store(round << kPlacesBits | opened_, std::memory_order_release);
  if (places >= threads_.size()) return gate_.notify_all();
  for (std::size_t i = 0; i < places; ++i) gate_.notify_one();
}

std::uint32_t ThreadPool::Close() {
  return opened_ - Places(gate_.fetch_and(~kPlacesMask, std::memory_order_acq_rel));
}

void ThreadPool::Call(std::size_t number) noexcept {
  try {
    (*work_)(number);
  } catch (...) {
    failures_[number] = std::current_exception();
  }
}

void ThreadPool::Serve() {
  std::uint32_t served = kNoRound;  // the Run that this thread has entered last
  std::uint32_t gate = gate_.load(std::memory_order_acquire);
  for (;;) {
    if (Round(gate) == served || Places(gate) == 0) {
      gate = AwaitChange(gate_, gate, spins_);
    } else if (gate_.compare_exchange_weak(gate, gate - 1, std::memory_order_acq_rel, std::memory_order_acquire)) {
      served = Round(gate);
      if (served == kEnd) return;
      Call(Places(gate));
      left_.fetch_add(1, std::memory_order_release);
      left_.notify_one();
      gate = gate_.load(std::memory_order_acquire);
    }
  }
}

}  // namespace troupe
