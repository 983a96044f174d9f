// RunFeed: the timeline of a live run, and its newest state, between the thread that delivers frames and the threads
// that serve viewers. Follower: observes the run as long as there are viewers.
//
// A viewer may connect at any time, miss frames, and ask for the past of before it came. So the timeline has two
// sources: the states that were received, and the run's journal for all before and between. Positions count states from
// the start of the run, those included without a receiver; the journal tells the position of the first one.
//
// Frames are accepted only in order and only if they fit the announced world: a peer on the network may send any.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "common/spatial/scene_cache.h"
#include "recording/timeline/timeline.h"
#include "transport/protocol/transport.h"
#include "viewer/gateway/viewer_gateway.h"

namespace troupe {

// Between two readings of the journal is at least so many times the time of one.
inline constexpr int kJournalShare = 10;

// A copy of the newest content of a feed, but for the events.
struct FeedHead {
  std::uint64_t version = 0;  // of the whole content; 0: nothing yet
  SharedState state;          // null: no run was found yet, or it has ended
  bool paused = false;
  bool last = false;                     // the run has ended in order
  std::vector<RobotCommand> goals = {};  // in force, with their robots
  std::optional<StatusMessage> status;
  // Counts the lists of events: that of another run, or one that was completed by the journal.
  std::uint64_t event_list = 0;
};

// Counted since the run has been followed, robot by robot.
struct AgentLosses {
  std::uint64_t lost = 0;      // robots that have lost their agents
  std::uint64_t rejoined = 0;  // of those, that have one again
};

struct FeedContent : FeedHead {
  std::deque<NumberedEvent> events;  // the newest of the run, at most kEventsKept; their numbers have no gaps
};

// The first event after the one with this number.
std::deque<NumberedEvent>::const_iterator EventsAfter(const std::deque<NumberedEvent>& events, std::uint64_t number);

// Its states are those that were received since the run has been followed, the newest in a bounded memory, and before
// them those of the run's journal. A position counts the ticks, too, that were not received.
//
// Threads: the handler calls come on one thread, At on another, the others on any.
class RunFeed : public ObserverHandler, public Timeline {
 public:
  // `scenes`: of the process; null: no service is in it.
  explicit RunFeed(std::shared_ptr<SceneCache> scenes = nullptr, std::size_t max_kept_bytes = std::size_t{128} << 20);

  WorldCache& worlds() { return worlds_; }

  std::shared_ptr<const TimeSpans> Spans() const override;
  Result<SharedState> At(std::uint64_t position) override;
  // By the journal, as far as it was read.
  Result<std::string> VehicleStateAt(const std::string& robot, std::uint64_t position) override;
  // The last position of the journal that was read; 0: none was.
  std::uint64_t RecordedUpTo() const;

  // Completes the past and the events by the run's journal as it is now; null: there is none. A run that has ended
  // without having been followed is then shown at its end. On any thread.
  void SetRecorded(const std::shared_ptr<RecordedTimeline>& recorded);
  // A run is in view.
  bool has_state() const;
  // States were not received, so that the journal should be read again.
  bool lacks_states() const;

  // The newest content, and the losses of agents.
  std::pair<FeedHead, AgentLosses> Head() const;
  // Copies the content to `content` unless it has the same version already.
  void Read(FeedContent& content) const;
  // The service has ended since the last call.
  bool ConsumeServiceGone();
  // Forgets the run, unless it has ended in order: its end stays in view. REQUIRES: no handler call runs.
  void Clear();

  void OnSession(const SessionMessage& session) override;
  void OnFrame(const SharedFrame& frame) override;
  void OnStatus(const StatusMessage& status) override;
  void OnServiceGone() override;

 private:
  // All of these: REQUIRES: mutex_ is locked.
  // The position after the newest one that is known.
  std::uint64_t NextPosition() const;
  // Another run begins with this frame. Returns the last position whose events are listed, from the recording.
  std::optional<std::uint64_t> BeginRun(const FrameMessage& frame);
  // Appends a state. Returns it, with its position.
  SharedState Keep(const SharedFrame& frame);
  void CountLosses(const FrameMessage& frame);
  // The list of events begins with the recording's; returns the position of its last state.
  std::uint64_t CompleteEvents(const RecordedTimeline& recorded);

  const std::shared_ptr<SceneCache> scenes_;
  WorldCache worlds_;
  mutable std::mutex mutex_;  // guards the others but for announced_
  KeptStates kept_;
  TimeSpans kept_spans_;
  std::uint64_t next_ = 0;                              // position of the next state, if no tick is missing
  std::shared_ptr<RecordedTimeline> recorded_;          // null: none
  mutable std::shared_ptr<const TimeSpans> all_spans_;  // null: they are to be joined again
  FeedContent content_;
  bool service_gone_ = false;
  bool lacks_states_ = false;
  std::uint64_t events_ = 0;
  AgentLosses losses_;
  std::set<RobotId> without_agent_;
  // The world of the frames that follow, of the newest session.
  std::shared_ptr<const TimelineWorld> announced_;
};

// Without viewers, and while none is expected, the gateway has no DDS participant and receives nothing, so that it
// costs a run nothing. It follows a run all the time whose past it would not know otherwise (RunLink::follows_always).
// While it finds no run it reads the journal now and then, because a run may end before it is found.
//
// Threads: any.
class Follower {
 public:
  // The link and the feed must outlive this.
  Follower(RunLink& link, RunFeed& feed);
  ~Follower();
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

  // Whether there are viewers. Does not wait.
  void SetWanted(bool wanted);
  // Another request for the run is expected within this time: of a page that is loaded, within seconds, as the
  // discovery of the run takes part of one. Does not wait.
  void Expect(std::chrono::seconds time);
  // The reason why the run cannot be observed; empty: it is, or is not wanted.
  std::string problem() const;

 private:
  void Run();

  RunLink& link_;
  RunFeed& feed_;
  mutable std::mutex mutex_;  // guards the next four
  bool wanted_ = false;
  std::chrono::steady_clock::time_point wanted_until_;
  bool ending_ = false;
  std::string problem_;
  std::condition_variable changed_;
  std::thread thread_;  // last
};

}  // namespace troupe
