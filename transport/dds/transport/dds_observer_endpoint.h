// An observer's end of a DdsTransport: a viewer, a monitor. It rebuilds the states on the thread that receives the
// frames, however slow the handler: a slow handler loses frames, but that makes no gap, and so costs the service no
// whole frame.
//
// Three parts. FrameFollower turns frames with changes into whole states. ObserverProtocol decides what to pass on and
// when to ask for a whole frame; it has no threads and no clock, so that tests drive it directly. DdsObserverEndpoint
// connects both to DDS and to the queue of the handler (ObserverQueue), whose thread is the only one that calls the
// handler.
//
// Frames are best effort for observers: a lost one is not resent by DDS, so that no observer can delay the service's
// writer. The gap is found by the tick, and one whole frame repairs it for all observers.
//
// Locks: `mutex_` guards the protocol; `gather_mutex_` only the waiting of the receiving thread, so that the destructor
// can end it.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>

#include "idl/frame.h"
#include "transport/dds/convert/convert.h"
#include "transport/dds/transport/dds_connection.h"
#include "transport/dds/transport/senders.h"
#include "transport/protocol/delivery.h"
#include "transport/protocol/messages.h"
#include "transport/protocol/transport.h"
#include "troupe/result.h"

namespace troupe::dds {

// FrameFollower: rebuilds the states of a run from its frames on the wire, most of which have only the changes since
// the previous frame. Not thread-safe.
class FrameFollower {
 public:
  // Brings frame() up to this one. A frame that is older, or has the changes since a missing frame, has no effect. The
  // error is that of a frame that breaks the contract of idl/frame.idl; frame() is then unknown.
  Status Read(const troupe_wire_Frame& wire);

  // The newest frame that could be read, with its whole state. REQUIRES: known().
  const FrameMessage& frame() const { return frame_; }
  bool known() const { return known_; }
  // A later frame than frame() was seen, but could not be read. Only a whole frame helps.
  bool has_gap() const { return has_gap_; }

  void Reset() { *this = FrameFollower(); }

 private:
  FrameMessage frame_;
  bool known_ = false;
  bool has_gap_ = false;
};

// ObserverProtocol: the part of an observer in the tick protocol: from sessions and frames on the wire to the frames of
// a run in their order, with requests for whole ones after a gap. Without threads and without a clock: times are in s,
// of any clock that does not decrease. Not thread-safe.
class ObserverProtocol {
 public:
  // s. After this time without an answer a request is resent: it, or the frame, was lost, or the service did not know
  // this observer yet. Longer than the time for which a service ignores further requests.
  static constexpr double kRequestPeriod = 0.05;

  void OnSession(RunId run, Edition world_edition) { world_editions_[run] = world_edition; }
  void OnStatus(const StatusMessage& status) { status_ = status; }
  // The service of the run has ended. True if it was the last one.
  bool OnEnd(RunId run);
  // The error is that of a malformed frame, which has no further effect.
  Status OnFrame(const troupe_wire_Frame& frame);
  // The answer to a request, or to that of another observer.
  Status OnWholeFrame(const troupe_wire_Frame& frame);

  // The newest frame, once, as soon as its world is known; else null. Valid until the next call of a function above.
  const FrameMessage* Next();

  // The next whole frame shall be returned by Next, even if it was already.
  void AskAgain() { again_ = true; }
  bool has_gap() const { return follower_.has_gap(); }
  // Newer frames exist than the newest that is known.
  bool IsBehind() const;
  // Whether to send a request now: not without a service, nor while the last one may still be answered.
  bool MayRequest(double now);

 private:
  // Run, edition, tick, paused by a user, last: two frames that agree in these are the same.
  using FrameKey = std::tuple<RunId, Edition, Tick, bool, bool>;

  std::map<RunId, Edition> world_editions_;  // of the newest session of each run that has a live service
  FrameFollower follower_;
  std::optional<FrameKey> returned_;     // the newest frame that Next has returned
  std::optional<StatusMessage> status_;  // the newest
  std::optional<double> requested_at_;   // nothing: no request is open
  bool again_ = false;
};

class DdsObserverEndpoint : public ObserverEndpoint {
 public:
  explicit DdsObserverEndpoint(const DdsConnection& connection);  // which must outlive it
  ~DdsObserverEndpoint() override;

  void Start(ObserverHandler& handler) override;
  void RequestFrame() override;

 private:
  using Clock = std::chrono::steady_clock;

  void DrainSessions();
  void DrainStatuses();
  void DrainFrames();
  // Called by the listener of frames_, on the thread that receives. If that had to wait for this frame, it sleeps for a
  // moment, so that more frames gather in the socket, and then reads all of them.
  void GatherFrames();

  // The functions below: REQUIRES: mutex_ is locked.
  void EndRunsOf(const Sender& service);
  void ReadFrames();
  using Read = Status (ObserverProtocol::*)(const troupe_wire_Frame&);
  void ReadFrame(WireInbox<troupe_wire_Frame>& inbox, Read read, const troupe_wire_Frame& frame, const Sender& sender);
  // Posts the newest frame, unless it was posted already or its world is not known yet.
  void PostFrame();
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
  ServiceRegistry services_;
  ObserverProtocol protocol_;

  std::optional<ObserverQueue> queue_;  // once started
};

}  // namespace troupe::dds
