#include "common/base/thread_pool.h"

#include <utility>

namespace troupe {

ThreadPool::ThreadPool(std::size_t size) {
  failures_.resize(size);
  for (std::size_t number = 1; number < size; ++number) threads_.emplace_back([this, number] { Serve(number); });
}

ThreadPool::~ThreadPool() {
  work_ = nullptr;
  ++round_;
  round_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ThreadPool::Run(const std::function<void(std::size_t)>& work) {
  work_ = &work;
  busy_ = static_cast<std::uint32_t>(threads_.size());
  ++round_;
  round_.notify_all();
  Call(0);
  for (std::uint32_t left = busy_; left != 0; left = busy_) busy_.wait(left);
  for (std::exception_ptr& failure : failures_) {
    if (failure) std::rethrow_exception(std::exchange(failure, nullptr));
  }
}

void ThreadPool::Call(std::size_t number) noexcept {
  try {
    (*work_)(number);
  } catch (...) {
    failures_[number] = std::current_exception();
  }
}

void ThreadPool::Serve(std::size_t number) {
  for (std::uint32_t seen = 0;; ++seen) {
    round_.wait(seen);
    if (work_ == nullptr) return;
    Call(number);
    if (--busy_ == 0) busy_.notify_one();
  }
}

}  // namespace troupe
