#include "viewer/gateway/follower.h"

#include <chrono>
#include <memory>
#include <utility>

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// For so long the run is observed without viewers: a page that is loaded again is gone for a moment, and one that is
// loaded has no connection yet.
constexpr auto kGraceTime = std::chrono::seconds(5);
// Between two looks at the state of the observation.
constexpr auto kPeriod = std::chrono::seconds(1);

}  // namespace

Follower::Follower(RunLink& link, RunFeed& feed) : link_(link), feed_(feed), thread_([this] { Run(); }) {}

Follower::~Follower() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Follower::SetWanted(bool wanted) {
  {
    const std::lock_guard lock(mutex_);
    if (wanted_ == wanted) return;
    wanted_ = wanted;
  }
  changed_.notify_all();
}

void Follower::Expect() {
  {
    const std::lock_guard lock(mutex_);
    wanted_until_ = Clock::now() + kGraceTime;
  }
  changed_.notify_all();
}

std::string Follower::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

void Follower::Run() {
  std::unique_ptr<RunObservation> observation;
  std::unique_lock lock(mutex_);
  while (!ending_) {
    const auto now = Clock::now();
    if (wanted_) wanted_until_ = now + kGraceTime;
    const bool open = now < wanted_until_ && !observation;
    const bool close = observation && now >= wanted_until_;
    lock.unlock();
    // The next run of the session may have other keys.
    if (close || (feed_.ConsumeServiceGone() && observation)) {
      observation.reset();
      feed_.Clear();  // its state is not the newest for long
    }
    std::string problem;
    if (open) {
      Result<std::unique_ptr<RunObservation>> opened = link_.Observe(feed_);
      if (opened.ok()) {
        observation = std::move(opened).value();
      } else {
        problem = opened.error().message;
      }
    }
    lock.lock();
    if (open) problem_ = std::move(problem);
    const bool wanted = wanted_;
    const Clock::time_point until = wanted_until_;
    changed_.wait_for(lock, kPeriod, [&] { return ending_ || wanted_ != wanted || wanted_until_ != until; });
  }
  lock.unlock();
  observation.reset();
}

}  // namespace troupe
