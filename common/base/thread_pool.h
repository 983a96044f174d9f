// ThreadPool: threads that help with the work of each tick.
//
// For short pieces of work, at every tick. Threads are woken by an atomic gate; the caller begins at once and does not
// wait for the others. The work must be divided by the calls themselves (an atomic counter), and its result must not
// depend on which call does a part: sums and orders are made afterwards, by index.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace troupe {

class ThreadPool {
 public:
  // `size` threads, with the caller of Run as one of them; the others start in the first Run that has work for them.
  // 0 counts as 1.
  explicit ThreadPool(std::size_t size);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  std::size_t size() const { return size_; }

  // Calls work(0) on this thread, and beside it work(1) to work(most - 1) on other threads, as they wake up: threads
  // that come after the return of work(0) are left out. So each call takes parts of the work as long as there are any,
  // and a Run never waits for a thread that the system has not woken yet. Returns when all calls have returned;
  // rethrows the exception of the one with the lowest number that threw one. During the Run of another thread it calls
  // work(0) only. REQUIRES: most >= 1
  void Run(std::size_t most, const std::function<void(std::size_t)>& work);

 private:
  using Gate = std::atomic<std::uint32_t>;

  void Serve();
  void Call(std::size_t number) noexcept;
  void StartThreads(std::size_t count);
  void Open(std::uint32_t round, std::size_t places);
  // The threads that have entered since Open.
  std::uint32_t Close();

  const std::size_t size_;
  const bool spins_;  // threads wait for a moment before they sleep, because each has a processor
  std::mutex running_;
  const std::function<void(std::size_t)>* work_ = nullptr;  // of the Run
  std::uint32_t opened_ = 0;                                // places of the last Open
  Gate gate_ = 0;                                           // the number of the Run, and the places left in it
  Gate left_ = 0;                                           // threads that have entered and left
  std::vector<std::exception_ptr> failures_;                // by number
  std::vector<std::thread> threads_;
};

}  // namespace troupe
