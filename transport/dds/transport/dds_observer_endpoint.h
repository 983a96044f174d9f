// An observer's end of a DdsTransport. It rebuilds the states on the thread that receives the frames, however slow the
// handler: a slow handler loses frames, but that makes no gap, and so costs the service no whole frame.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>

#include "transport/dds/convert/topic_types.h"
#include "transport/dds/transport/dds_connection.h"
#include "transport/dds/transport/known_services.h"
#include "transport/dds/transport/observer_protocol.h"
#include "transport/protocol/observer_queue.h"
#include "transport/protocol/transport.h"

namespace troupe::dds {

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
  KnownServices services_;
  ObserverProtocol protocol_;

  std::optional<ObserverQueue> queue_;  // once started
};

}  // namespace troupe::dds
