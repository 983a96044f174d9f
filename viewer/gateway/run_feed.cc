#include "viewer/gateway/run_feed.h"

#include <utility>

namespace troupe {

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

void RunFeed::OnFrame(const SharedFrame& shared) {
  const FrameMessage& frame = *shared;
  if (!announced_ || frame.run != announced_->run || frame.world_edition != announced_->edition) return;
  if (!announced_->scene->CheckState(frame.state).ok()) return;
  const std::lock_guard lock(mutex_);
  const std::pair at(frame.edition, frame.state.tick);
  if (!content_.world || content_.world->run != frame.run) {
    content_.events.clear();
    content_.status.reset();
    newest_events_.reset();
    history_.Clear();
    remembered_.reset();
  } else if (at < std::pair(content_.edition, content_.state->tick)) {
    return;
  }
  ++content_.version;
  content_.world = announced_;
  content_.state = {shared, &frame.state};
  content_.state_hash = frame.state_hash;
  content_.edition = frame.edition;
  content_.paused = frame.paused;
  content_.last = frame.last;
  if (!remembered_ || at > *remembered_) {  // a frame may be delivered twice
    remembered_ = at;
    content_.position = history_.Add({0, announced_, content_.state, frame.state_hash, frame.edition});
  }
  AddEvents(frame);
}

// A frame may be delivered twice.
void RunFeed::AddEvents(const FrameMessage& frame) {
  const std::pair at(frame.edition, frame.state.tick);
  if (newest_events_ && at <= *newest_events_) return;
  newest_events_ = at;
  const WorldDescription& world = content_.world->scene->world();
  for (const Event& event : frame.events) {
    content_.events.push_back({++events_, content_.position, event, NamesIn(world, event)});
  }
  while (content_.events.size() > kEventsKept) content_.events.pop_front();
}

void RunFeed::OnStatus(const StatusMessage& status) {
  const std::lock_guard lock(mutex_);
  if (!content_.world || content_.world->run != status.run) return;
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
  if (content_.last || !content_.world) return;
  ++content_.version;
  content_.world.reset();
}

}  // namespace troupe
