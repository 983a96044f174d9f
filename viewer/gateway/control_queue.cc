#include "viewer/gateway/control_queue.h"

#include <utility>

namespace troupe {

ControlQueue::ControlQueue(RunLink& link, std::function<void()> on_answer)
    : link_(link), on_answer_(std::move(on_answer)), thread_([this] { Run(); }) {}

ControlQueue::~ControlQueue() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

bool ControlQueue::Add(ViewerId viewer, PageControl control) {
  {
    const std::lock_guard lock(mutex_);
    if (tasks_.size() >= kMostWaiting) return false;
    tasks_.push_back({viewer, std::move(control)});
  }
  changed_.notify_all();
  return true;
}

std::vector<ControlQueue::Answer> ControlQueue::TakeAnswers() {
  const std::lock_guard lock(mutex_);
  return std::exchange(answers_, {});
}

void ControlQueue::Run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return ending_ || !tasks_.empty(); });
    if (ending_) return;
    const Task task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    std::string text = PageReplyText(task.control.id, link_.Ask(task.control.request));
    lock.lock();
    answers_.push_back({task.viewer, std::move(text)});
    on_answer_();
  }
}

}  // namespace troupe
