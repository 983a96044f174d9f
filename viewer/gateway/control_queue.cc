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
  return AddTask({viewer, std::move(control)});
}

bool ControlQueue::Add(ViewerId viewer, EditRequest request) {
  return AddTask({viewer, std::move(request)});
}

bool ControlQueue::AddTask(Task task) {
  {
    const std::lock_guard lock(mutex_);
    if (tasks_.size() >= kMostWaiting) return false;
    tasks_.push_back(std::move(task));
  }
  changed_.notify_all();
  return true;
}

std::vector<ControlQueue::Answer> ControlQueue::TakeAnswers() {
  const std::lock_guard lock(mutex_);
  return std::exchange(answers_, {});
}

std::string ControlQueue::Answered(const Task& task) {
  if (const auto* edit = std::get_if<EditRequest>(&task.request))
    return EditReplyText(edit->id, link_.Edit(edit->text));
  const auto& control = std::get<PageControl>(task.request);
  return PageReplyText(control.id, link_.Ask(control.request));
}

void ControlQueue::Run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return ending_ || !tasks_.empty(); });
    if (ending_) return;
    const Task task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    std::string text = Answered(task);
    lock.lock();
    answers_.push_back({task.viewer, std::move(text)});
    on_answer_();
  }
}

}  // namespace troupe
