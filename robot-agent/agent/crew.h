// Crew: a few threads that share a piece of work, again and again.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace troupe {

class Crew {
 public:
  // `size` threads, the caller of Run among them. REQUIRES: size >= 1
  explicit Crew(std::size_t size);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  std::size_t size() const { return threads_.size() + 1; }

  // Calls work(0) to work(size - 1), each on a thread of its own; returns when all have returned. `work` must not
  // throw.
  void Run(const std::function<void(std::size_t)>& work);

 private:
  void Serve(std::size_t number);

  const std::function<void(std::size_t)>* work_ = nullptr;  // null: go home
  std::atomic<std::uint32_t> round_ = 0;                    // grows when there is work
  std::atomic<std::uint32_t> busy_ = 0;                     // threads still at work
  std::vector<std::thread> threads_;
};

}  // namespace troupe
