// ThreadPool: threads that divide the work of each tick among them.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

namespace troupe {

class ThreadPool {
 public:
  // `size` threads, with the caller of Run as one of them. REQUIRES: size >= 1
  explicit ThreadPool(std::size_t size);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  std::size_t size() const { return threads_.size() + 1; }

  // Calls work(0) to work(size - 1), each on a thread of its own; returns when all calls have returned. Rethrows the
  // exception of the call with the lowest number that threw one.
  void Run(const std::function<void(std::size_t)>& work);

 private:
  void Serve(std::size_t number);
  void Call(std::size_t number) noexcept;

  const std::function<void(std::size_t)>* work_ = nullptr;  // null: the threads terminate
  std::atomic<std::uint32_t> round_ = 0;                    // incremented for each Run
  std::atomic<std::uint32_t> busy_ = 0;                     // threads whose call has not returned
  std::vector<std::exception_ptr> failures_;                // by number
  std::vector<std::thread> threads_;
};

}  // namespace troupe
