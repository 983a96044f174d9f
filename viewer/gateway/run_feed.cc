#include "viewer/gateway/run_feed.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <utility>

#include "common/base/or_failure.h"
#include "viewer/gateway/page_messages.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// For so long the run is observed without viewers: a page that is loaded again is gone for a moment.
constexpr auto kGraceTime = std::chrono::seconds(5);
// Between two looks at the state of the observation, and at least between two readings of the journal.
constexpr auto kPeriod = std::chrono::seconds(1);

}  // namespace

RunFeed::RunFeed(std::shared_ptr<SceneCache> scenes, std::size_t max_kept_bytes)
    : scenes_(std::move(scenes)), worlds_(EncodeWorld), kept_(max_kept_bytes) {}

std::deque<NumberedEvent>::const_iterator EventsAfter(const std::deque<NumberedEvent>& events, std::uint64_t number) {
  return std::partition_point(events.begin(), events.end(),
                              [&](const NumberedEvent& event) { return event.number <= number; });
}

std::pair<FeedHead, AgentLosses> RunFeed::Head() const {
  const std::lock_guard lock(mutex_);
  return {content_, losses_};
}

void RunFeed::Read(FeedContent& content) const {
  const std::lock_guard lock(mutex_);
  if (content.version == content_.version) return;
  // Only the new ones are copied: there may be thousands, 60 times a second.
  const bool is_same_list = content.event_list == content_.event_list;
  if (!is_same_list) content.events.clear();
  const std::uint64_t known = content.events.empty() ? 0 : content.events.back().number;
  content.events.insert(content.events.end(), EventsAfter(content_.events, known), content_.events.end());
  while (content.events.size() > kEventsKept) content.events.pop_front();
  static_cast<FeedHead&>(content) = static_cast<const FeedHead&>(content_);
}

bool RunFeed::ConsumeServiceGone() {
  const std::lock_guard lock(mutex_);
  return std::exchange(service_gone_, false);
}

// The work for a new world is done here, on the thread of the observer: it may take a while, and loses frames only.
void RunFeed::OnSession(const SessionMessage& session) {
  if (announced_ && announced_->run == session.run && announced_->edition == session.world_edition) return;
  announced_ = worlds_.Of(session, scenes_ != nullptr ? scenes_->Find(session.world) : nullptr);
}

// A frame may be delivered twice: paused, and to be answered.
void RunFeed::OnFrame(const SharedFrame& shared) {
  const FrameMessage& frame = *shared;
  if (!announced_ || frame.run != announced_->run || frame.world_edition != announced_->edition) return;
  if (!announced_->scene->CheckState(frame.state).ok()) return;
  const std::lock_guard lock(mutex_);
  if (content_.state && content_.state->world->run != frame.run) content_.state.reset();
  const TimelineState* const before = content_.state.get();
  const std::pair at(frame.edition, frame.state.tick);
  if (before != nullptr && at < std::pair(before->edition, before->state->tick)) return;
  ++content_.version;
  content_.paused = frame.paused && !frame.holds;
  content_.last = frame.last;
  // A paused frame has no commands; those from before the pause are in force after it.
  if (before == nullptr || !frame.paused) content_.goals.clear();
  if (!frame.paused) {
    std::copy_if(frame.commands.begin(), frame.commands.end(), std::back_inserter(content_.goals),
                 [](const RobotCommand& command) { return command.goal && !command.goal->waypoints.empty(); });
  }
  if (before != nullptr && at == std::pair(before->edition, before->state->tick)) return;
  std::optional<std::uint64_t> listed_to;  // of states whose events are in the list, from the recording
  if (before == nullptr) listed_to = BeginRun(frame);
  const std::uint64_t expected = NextPosition();
  content_.state = Keep(shared);
  const bool is_behind_gap = content_.state->position > expected;
  lacks_states_ = lacks_states_ || (is_behind_gap && recorded_ != nullptr);
  CountLosses(frame);
  if (listed_to && content_.state->position <= *listed_to) return;
  for (const Event& event : frame.events) {
    const EventNames names = NamesIn(announced_->description(), event);
    content_.events.push_back({++events_, content_.state->position, event, names});
  }
  while (content_.events.size() > kEventsKept) content_.events.pop_front();
}

std::optional<std::uint64_t> RunFeed::BeginRun(const FrameMessage& frame) {
  content_.events.clear();
  ++content_.event_list;
  content_.status.reset();
  kept_.Clear();
  kept_spans_.Clear();
  all_spans_.reset();
  losses_ = {};
  without_agent_.clear();
  if (recorded_ != nullptr && recorded_->run() != frame.run) recorded_.reset();
  if (recorded_ == nullptr) return std::nullopt;
  next_ = recorded_->Spans()->PositionOf({frame.edition, frame.state.tick});
  return CompleteEvents(*recorded_);
}

SharedState RunFeed::Keep(const SharedFrame& shared) {
  const FrameMessage& frame = *shared;
  TimelineState state{
      next_, announced_, {shared, &frame.state}, frame.state_hash, frame.edition, {shared, &frame.events}};
  if (!kept_.empty()) {
    // An edit makes one state; within an edition ticks count up, also those that were not received.
    const TimelineState& before = *kept_.last();
    const bool counts_up = before.edition == frame.edition && frame.state.tick > before.state->tick;
    state.position = before.position + (counts_up ? frame.state.tick - before.state->tick : 1);
  }
  next_ = state.position + 1;
  auto kept = std::make_shared<const TimelineState>(std::move(state));
  kept_.Add(kept);
  kept_spans_.Add(kept->position, frame.state.tick, frame.edition);
  kept_spans_.DropBefore(kept_.first());
  all_spans_.reset();
  return kept;
}

void RunFeed::CountLosses(const FrameMessage& frame) {
  for (const Event& event : frame.events) {
    if (event.type == EventType::kLeft && event.robot && without_agent_.insert(*event.robot).second) ++losses_.lost;
    if (event.type == EventType::kJoined && event.robot) losses_.rejoined += without_agent_.erase(*event.robot);
  }
}

// Without kept states the journal's last one precedes.
std::uint64_t RunFeed::NextPosition() const {
  if (!kept_.empty()) return kept_.last()->position + 1;
  return recorded_ == nullptr ? 0 : recorded_->Spans()->last() + 1;
}

// Joined once for each change, as it is asked for in each update of each viewer.
std::shared_ptr<const TimeSpans> RunFeed::Spans() const {
  const std::lock_guard lock(mutex_);
  if (all_spans_ != nullptr) return all_spans_;
  auto spans = recorded_ == nullptr ? std::make_shared<TimeSpans>() : std::make_shared<TimeSpans>(*recorded_->Spans());
  for (const TimeSpan& span : kept_spans_.all()) spans->Append(span);
  // The journal may have been read after the newest frame was received.
  if (!kept_.empty()) spans->DropAfter(kept_.last()->position);
  return all_spans_ = std::move(spans);
}

// The recording is read without the mutex: stepping it may take a while, and frames must not wait.
Result<SharedState> RunFeed::At(std::uint64_t position) {
  std::shared_ptr<RecordedTimeline> recorded;
  SharedState nearest;
  {
    const std::lock_guard lock(mutex_);
    recorded = recorded_;
    if (!kept_.empty()) nearest = kept_.Nearest(position);
  }
  if (nearest != nullptr && (nearest->position == position || recorded == nullptr)) return nearest;
  if (recorded == nullptr) return Failure("there is no past state");
  return nearest == nullptr || position <= recorded->Spans()->last() ? recorded->At(position) : nearest;
}

Result<std::string> RunFeed::VehicleStateAt(const std::string& robot, std::uint64_t position) {
  std::shared_ptr<RecordedTimeline> recorded;
  {
    const std::lock_guard lock(mutex_);
    recorded = recorded_;
  }
  return recorded != nullptr ? recorded->VehicleStateAt(robot, position) : std::string();
}

std::uint64_t RunFeed::RecordedUpTo() const {
  const std::lock_guard lock(mutex_);
  return recorded_ != nullptr ? recorded_->Spans()->last() : 0;
}

// The numbers begin again, so that viewers replace their lists (event_list).
std::uint64_t RunFeed::CompleteEvents(const RecordedTimeline& recorded) {
  const std::uint64_t last = recorded.Spans()->last();
  std::deque<NumberedEvent> events = recorded.Events();
  for (NumberedEvent& event : content_.events) {
    if (event.position > last) events.push_back(std::move(event));
  }
  while (events.size() > kEventsKept) events.pop_front();
  content_.events = std::move(events);
  events_ = 0;
  for (NumberedEvent& event : content_.events) event.number = ++events_;
  ++content_.event_list;
  ++content_.version;
  return last;
}

// A journal of another run than the one in view is not used.
void RunFeed::SetRecorded(const std::shared_ptr<RecordedTimeline>& recorded) {
  // Before others can call it.
  Result<SharedState> end = Failure("it continues");
  if (recorded != nullptr && recorded->is_whole()) end = recorded->At(recorded->Spans()->last());
  const std::lock_guard lock(mutex_);
  if (recorded != nullptr && content_.state && content_.state->world->run != recorded->run()) return;
  recorded_ = recorded;
  all_spans_.reset();
  if (recorded == nullptr) return;
  lacks_states_ = false;
  if (!content_.state) {
    if (!end.ok()) return;
    content_.events.clear();
    content_.state = end.value();
    content_.last = true;
    content_.paused = false;
  }
  CompleteEvents(*recorded);
}

bool RunFeed::has_state() const {
  const std::lock_guard lock(mutex_);
  return content_.state != nullptr;
}

bool RunFeed::lacks_states() const {
  const std::lock_guard lock(mutex_);
  return lacks_states_;
}

// A status has no tick: it is accepted for the run in view.
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

// The end of a run stays in view, for viewers that come later.
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

// Under the mutex for the value alone: the server's thread must not wait for an observation.
void Follower::SetWanted(bool wanted) {
  {
    const std::lock_guard lock(mutex_);
    if (wanted_ == wanted) return;
    wanted_ = wanted;
  }
  changed_.notify_all();
}

void Follower::Expect(std::chrono::seconds time) {
  {
    const std::lock_guard lock(mutex_);
    wanted_until_ = std::max(wanted_until_, Clock::now() + time);
  }
  changed_.notify_all();
}

std::string Follower::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

// Without the mutex while an observation is opened or closed or a journal is read, each of which may take seconds.
void Follower::Run() {
  std::unique_ptr<RunObservation> observation;
  Clock::time_point journal_at;  // it is not read again earlier
  std::unique_lock lock(mutex_);
  while (!ending_) {
    const auto now = Clock::now();
    if (wanted_ || link_.follows_always()) wanted_until_ = std::max(wanted_until_, now + kGraceTime);
    const bool open = now < wanted_until_ && !observation;
    const bool close = observation && now >= wanted_until_;
    lock.unlock();
    const bool is_gone = feed_.ConsumeServiceGone();
    const bool is_over = observation && (is_gone || observation->IsOutdated());
    if (close || is_over) {
      observation.reset();
      feed_.Clear();  // its state is not the newest for long
    }
    // Before the observation: a frame of the run has its position by the journal. And later: a run that ends before the
    // observation has found it sends no frame, and its journal may have been read when it was not whole.
    if (open || (observation && !feed_.has_state() && now >= journal_at)) {
      try {
        feed_.SetRecorded(link_.ReadJournal(feed_.worlds()));
      } catch (const std::exception&) {  // as without memory: it is read again
      }
      const auto end = Clock::now();
      journal_at = end + std::max<Clock::duration>(kPeriod, kJournalShare * (end - now));
    }
    std::string problem;
    if (open) {
      Result<std::unique_ptr<RunObservation>> opened = OrFailure([this] { return link_.Observe(feed_); });
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
