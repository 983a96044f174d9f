// The least cost of lockstep over shared memory: a frame that is written once, one wake for N processes, a message of a
// proposal's size from each in a slot of its own, and one wake back by the last. Prints a JSON object.
//   shared_memory_barrier [agents=100] [ticks=1000]
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/syscall.h>

#include <atomic>
#include <climits>
#include <cstring>
#include <new>

#include "benchmarks/barrier_processes.h"

namespace troupe::bench {
namespace {

constexpr std::uint32_t kOver = ~std::uint32_t{0};
constexpr std::size_t kSlotBytes = 4096;

struct Header {
  alignas(64) std::atomic<std::uint32_t> tick = 0;  // the newest frame; agents wait for it
  alignas(64) std::atomic<int> missing = 0;
  alignas(64) std::atomic<std::uint32_t> complete = 0;  // ticks; the service waits for it
};

void Wait(const std::atomic<std::uint32_t>& word, std::uint32_t value) {
  syscall(SYS_futex, &word, FUTEX_WAIT, value, nullptr, nullptr, 0);
}
void WakeAll(const std::atomic<std::uint32_t>& word) {
  syscall(SYS_futex, &word, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
}

void RunAgent(Header& header, const char* frame, std::size_t frame_bytes, char* slot) {
  std::vector<char> copy(frame_bytes);
  std::uint32_t seen = 0;
  for (;;) {
    Wait(header.tick, seen);
    const std::uint32_t tick = header.tick.load(std::memory_order_acquire);
    if (tick == kOver) return;
    if (tick == seen) continue;
    seen = tick;
    std::memcpy(copy.data(), frame, frame_bytes);
    std::memcpy(slot, copy.data(), kProposalBytes);
    if (header.missing.fetch_sub(1, std::memory_order_acq_rel) != 1) continue;
    header.complete.store(tick, std::memory_order_release);
    WakeAll(header.complete);
  }
}

int Run(const BarrierOptions& options) {
  const auto agents = static_cast<std::size_t>(options.agents);
  const std::size_t frame_bytes = FrameBytes(options.agents);
  const std::size_t first_slot = (sizeof(Header) + frame_bytes + kSlotBytes - 1) / kSlotBytes * kSlotBytes;
  void* const memory =
      mmap(nullptr, first_slot + agents * kSlotBytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return std::perror("mmap"), 3;
  Header& header = *new (memory) Header;
  char* const begin = static_cast<char*>(memory);
  char* const frame = begin + sizeof(Header);
  std::vector<pid_t> children;
  for (std::size_t i = 0; i < agents; ++i) {
    children.push_back(Fork([&, i] { RunAgent(header, frame, frame_bytes, begin + first_slot + i * kSlotBytes); }));
  }
  std::vector<char> state(frame_bytes);
  std::vector<char> answers(agents * kProposalBytes);
  const auto step = [&](std::uint32_t tick) {
    std::memcpy(frame, state.data(), frame_bytes);
    header.missing.store(options.agents, std::memory_order_relaxed);
    header.tick.store(tick, std::memory_order_release);
    WakeAll(header.tick);
    while (header.complete.load(std::memory_order_acquire) != tick) Wait(header.complete, tick - 1);
    for (std::size_t i = 0; i < agents; ++i) {
      std::memcpy(answers.data() + i * kProposalBytes, begin + first_slot + i * kSlotBytes, kProposalBytes);
    }
  };
  step(1);  // all processes run
  const double used_before = ProcessorTime(children);
  const auto start = Clock::now();
  for (std::uint64_t tick = 0; tick < options.ticks; ++tick) step(static_cast<std::uint32_t>(tick + 2));
  const double share = 1e6 / static_cast<double>(options.ticks) / options.agents;
  const double wall = Since(start) * share;
  const double processor = (ProcessorTime(children) - used_before) * share;
  header.tick.store(kOver, std::memory_order_release);
  WakeAll(header.tick);
  WaitForAll(children);
  std::printf("{\"processes\": %d, \"ticks\": %lu, \"wall_us\": %.3f, \"processor_us\": %.3f}\n", options.agents,
              options.ticks, wall, processor);
  return 0;
}

}  // namespace
}  // namespace troupe::bench

int main(int argc, char** argv) {
  return troupe::bench::Run(troupe::bench::ParseBarrierOptions(argc, argv));
}
