// RequestQueue: performs the requests of viewers one after another, on a thread of its own: each may take long.
// Threads: any.
//
// A template, because the gateway has two: changes of the run, which wait for the service, and questions about the
// past. The web server's thread never waits for either; it adds a request and is woken for the answer. Bounded
// (kMaxWaiting), and a seek replaces the seek of the same viewer that still waits: while a slider is dragged only its
// newest position matters.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "viewer/gateway/web_server.h"

namespace troupe {

template <typename Request, typename Answer>
class RequestQueue {
 public:
  static constexpr std::size_t kMaxWaiting = 32;  // requests; more are refused

  // Both functions are called on the thread of the queue; `on_answer` when DrainAnswers has some.
  RequestQueue(std::function<Answer(const Request&)> perform, std::function<void()> on_answer)
      : perform_(std::move(perform)), on_answer_(std::move(on_answer)), thread_([this] { Run(); }) {}
  ~RequestQueue() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  RequestQueue(const RequestQueue&) = delete;
  RequestQueue& operator=(const RequestQueue&) = delete;

  // False if too many requests wait.
  bool Add(ViewerId viewer, Request request) {
    {
      const std::lock_guard lock(mutex_);
      if (waiting_.size() >= kMaxWaiting) return false;
      waiting_.emplace_back(viewer, std::move(request));
    }
    changed_.notify_all();
    return true;
  }
  // In place of the request of this kind and this viewer that waits, if there is one; else before all others.
  void Replace(ViewerId viewer, Request request) {
    {
      const std::lock_guard lock(mutex_);
      const auto same = std::find_if(waiting_.begin(), waiting_.end(), [&](const auto& waiting) {
        return waiting.first == viewer && waiting.second.index() == request.index();
      });
      if (same != waiting_.end()) {
        same->second = std::move(request);
      } else {
        waiting_.emplace_front(viewer, std::move(request));
      }
    }
    changed_.notify_all();
  }
  // Forgets the requests of a viewer that wait.
  void Remove(ViewerId viewer) {
    const std::lock_guard lock(mutex_);
    std::erase_if(waiting_, [&](const auto& waiting) { return waiting.first == viewer; });
  }

  std::vector<std::pair<ViewerId, Answer>> DrainAnswers() {
    const std::lock_guard lock(mutex_);
    return std::exchange(answers_, {});
  }

 private:
  void Run() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
      if (ending_) return;
      const auto [viewer, request] = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      try {
        Answer answer = perform_(request);
        lock.lock();
        answers_.emplace_back(viewer, std::move(answer));
        on_answer_();
      } catch (const std::exception&) {  // as without memory: the viewer gets no answer
        if (!lock.owns_lock()) lock.lock();
      }
    }
  }

  const std::function<Answer(const Request&)> perform_;
  const std::function<void()> on_answer_;
  std::mutex mutex_;  // guards the next three
  std::deque<std::pair<ViewerId, Request>> waiting_;
  std::vector<std::pair<ViewerId, Answer>> answers_;
  bool ending_ = false;
  std::condition_variable changed_;
  std::thread thread_;  // last
};

}  // namespace troupe
