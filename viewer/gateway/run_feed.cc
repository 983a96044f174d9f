#include "viewer/gateway/run_feed.h"

#include <utility>

#include "viewer/gateway/world_message.h"

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
  auto world = std::make_shared<ViewedWorld>();
  world->number = ++worlds_;
  world->run = session.run;
  world->edition = session.world_edition;
  world->message = std::make_shared<const std::string>(EncodeWorld(session, world->number));
  world->scene = std::make_shared<const Scene>(session.world);
  announced_ = std::move(world);
}

void RunFeed::OnFrame(const FrameMessage& frame) {
  if (!announced_ || frame.run != announced_->run || frame.world_edition != announced_->edition) return;
  const std::lock_guard lock(mutex_);
  if (!content_.world || content_.world->run != frame.run) {
    content_.events.clear();
    content_.status.reset();
    newest_events_.reset();
  } else if (std::pair(frame.edition, frame.state.tick) < std::pair(content_.edition, content_.state.tick)) {
    return;
  }
  ++content_.version;
  content_.world = announced_;
  content_.state = frame.state;
  content_.state_hash = frame.state_hash;
  content_.edition = frame.edition;
  content_.paused = frame.paused;
  content_.last = frame.last;
  AddEvents(frame);
}

// A frame may be delivered twice.
void RunFeed::AddEvents(const FrameMessage& frame) {
  const std::pair at(frame.edition, frame.state.tick);
  if (newest_events_ && at <= *newest_events_) return;
  newest_events_ = at;
  for (const Event& event : frame.events) content_.events.push_back({++events_, event});
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
