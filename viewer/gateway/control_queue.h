// ControlQueue: sends the requests of viewers to the run, one after another, on a thread of its own: a reply may take
// long.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "viewer/gateway/page_request.h"
#include "viewer/gateway/run_link.h"

namespace troupe {

using ViewerId = std::uint64_t;  // of a connection; never used twice

class ControlQueue {
 public:
  static constexpr std::size_t kMostWaiting = 32;  // requests; more are refused

  struct Answer {
    ViewerId viewer = 0;
    std::string text;  // PageReplyText
  };

  // The link must outlive this. `on_answer` is called, on the thread of the queue, when TakeAnswers has some.
  ControlQueue(RunLink& link, std::function<void()> on_answer);
  ~ControlQueue();
  ControlQueue(const ControlQueue&) = delete;
  ControlQueue& operator=(const ControlQueue&) = delete;

  // False if too many requests wait.
  bool Add(ViewerId viewer, PageControl control);
  bool Add(ViewerId viewer, EditRequest request);
  std::vector<Answer> TakeAnswers();

 private:
  struct Task {
    ViewerId viewer = 0;
    std::variant<PageControl, EditRequest> request;
  };

  bool AddTask(Task task);
  std::string Answered(const Task& task);
  void Run();

  RunLink& link_;
  const std::function<void()> on_answer_;
  std::mutex mutex_;  // guards the next three
  std::deque<Task> tasks_;
  std::vector<Answer> answers_;
  bool ending_ = false;
  std::condition_variable changed_;
  std::thread thread_;  // last
};

}  // namespace troupe
