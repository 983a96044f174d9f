#include "viewer/gateway/run_feed.h"

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

void RunFeed::Read(FeedContent& content) const {
  const std::lock_guard lock(mutex_);
  if (content.version != content_.version) content = content_;
}

bool RunFeed::ConsumeServiceGone() {
  const std::lock_guard lock(mutex_);
  return std::exchange(service_gone_, false);
}

// The work for a new world is done here, on the thread of the observer: it may take a while, and loses frames only.
void RunFeed::OnSession(const SessionMessage& session) {
  if (announced_ && announced_->run == session.run && announced_->edition == session.world_edition) return;
  announced_ = MakeViewedWorld(session, ++worlds_);
}

// A frame may be delivered twice: paused, and to be answered.
void RunFeed::OnFrame(const SharedFrame& shared) {
  const FrameMessage& frame = *shared;
  if (!announced_ || frame.run != announced_->run || frame.world_edition != announced_->edition) return;
  if (!announced_->scene->CheckState(frame.state).ok()) return;
  const std::lock_guard lock(mutex_);
  if (content_.state && content_.state->world->run != frame.run) content_.state.reset();
  const ViewedState* const before = content_.state.get();
  const std::pair at(frame.edition, frame.state.tick);
  if (before != nullptr && at < std::pair(before->edition, before->state->tick)) return;
  ++content_.version;
  content_.paused = frame.paused && !frame.holds;
  content_.last = frame.last;
  if (before != nullptr && at == std::pair(before->edition, before->state->tick)) return;
  if (before == nullptr) {
    content_.events.clear();
    content_.status.reset();
    history_.Clear();
  }
  content_.state = history_.Add({0, announced_, {shared, &frame.state}, frame.state_hash, frame.edition});
  for (const Event& event : frame.events) {
    const EventNames names = NamesIn(announced_->description(), event);
    content_.events.push_back({++events_, content_.state->position, event, names});
  }
  while (content_.events.size() > kEventsKept) content_.events.pop_front();
}

void RunFeed::OnStatus(const StatusMessage& status) {
  const std::lock_guard lock(mutex_);
  if (!content_.state || content_.state->world->run != status.run) return;
  ++content_.version;
  content_.status = status;
}

void RunFeed::OnServiceGone() {
  Clear();
  const std::lock_guard lock(mutex_);
  service_gone_ = true;
}

void RunFeed::Clear() {
  announced_.reset();
  const std::lock_guard lock(mutex_);
  if (content_.last || !content_.state) return;
  ++content_.version;
  content_.state.reset();
}

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
