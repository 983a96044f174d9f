// An observer's end of a DdsTransport. It rebuilds the states on the thread that receives the frames, however slow the
// handler: a slow handler loses frames, but that makes no gap, and so costs the service no whole frame.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>

#include "common/dds/convert/topic_types.h"
#include "common/dds/transport/dds_connection.h"
#include "common/dds/transport/frame_follower.h"
#include "common/dds/transport/known_services.h"
#include "common/protocol/observer_queue.h"
#include "common/protocol/transport.h"

namespace troupe::dds {

class DdsObserverEndpoint : public ObserverEndpoint {
 public:
  explicit DdsObserverEndpoint(const DdsConnection& connection);  // which must outlive it
  ~DdsObserverEndpoint() override;

  void Start(ObserverHandler& handler) override;
  void RequestFrame() override;

 private:
  using Clock = std::chrono::steady_clock;
  // Run, edition, tick, paused, last: two frames that agree in these are the same.
  using FrameKey = std::tuple<RunId, Edition, Tick, bool, bool>;

  void DrainSessions();
  void DrainStatuses();
  void DrainFrames();
  // Called by the listener of frames_, on the thread that receives. If that had to wait for this frame, it sleeps for a
  // moment, so that more frames gather in the socket, and then reads all of them.
  void GatherFrames();

  // The functions below: REQUIRES: mutex_ is locked.
  void EndRunsOf(const Sender& service);
  void EndRun(RunId run);
  void ReadFrame(WireInbox<troupe_wire_Frame>& inbox, const troupe_wire_Frame& frame, const Sender& sender);
  // Posts the follower's frame, unless it was posted already or its world is not known yet.
  void PostFrame();
  bool IsBehind() const;
  // Sends a request, unless the last one may still be answered.
  void RequestWholeFrame();

  Outbox<troupe_wire_FrameRequest> requests_;
  Inbox<troupe_wire_Session, SessionMessage> sessions_;
  Inbox<troupe_wire_Status, StatusMessage> statuses_;
  WireInbox<troupe_wire_Frame> frames_;
  WireInbox<troupe_wire_Frame> whole_frames_;
  const std::uint64_t id_;

  std::mutex gather_mutex_;  // guards the members up to the next mutex
  std::condition_variable closing_changed_;
  bool closing_ = false;
  Clock::time_point last_read_;  // when the last frames were read; for GatherFrames only
  std::atomic<bool> frames_are_short_ = false;

  std::mutex mutex_;  // guards the members below it
  KnownServices services_;
  std::map<RunId, Edition> world_editions_;  // of the newest session of each run that has a live service
  FrameFollower follower_;
  std::optional<FrameKey> posted_;                 // the newest frame posted to the handler
  std::optional<StatusMessage> status_;            // the newest
  std::optional<Clock::time_point> requested_at_;  // nothing: no request is open
  bool post_again_ = false;                        // the next whole frame, even if it was posted already

  std::optional<ObserverQueue> queue_;  // once started
};

}  // namespace troupe::dds
