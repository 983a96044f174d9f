// RunFeed: the newest state of a run, between the thread that delivers frames and the thread that serves the page.
//
// Threads: the handler calls come on one thread, Read on another.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "transport/protocol/transport.h"
#include "viewer/gateway/kept_states.h"
#include "viewer/gateway/past_state.h"

namespace troupe {

// A copy of the newest content of a feed.
struct FeedContent {
  std::uint64_t version = 0;                 // of everything below; 0: nothing yet
  std::shared_ptr<const ViewedWorld> world;  // null: no run was found yet, or it has ended
  std::shared_ptr<const WorldState> state;   // of that world
  std::uint64_t state_hash = 0;
  std::uint64_t position = 0;  // in the history
  Edition edition = 0;
  bool paused = false;
  bool last = false;  // the run has ended in order
  std::optional<StatusMessage> status;
  std::deque<NumberedEvent> events;  // the newest of the run, at most kEventsKept
};

class RunFeed : public ObserverHandler {
 public:
  explicit RunFeed(std::size_t history_bytes = std::size_t{128} << 20) : history_(history_bytes) {}

  // The states of the run since it has been followed.
  KeptStates& history() { return history_; }

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
  void AddEvents(const FrameMessage& frame);

  KeptStates history_;
  mutable std::mutex mutex_;  // guards content_ and service_gone_
  FeedContent content_;
  bool service_gone_ = false;
  // Of the newest session: the world of the frames that follow.
  std::shared_ptr<const ViewedWorld> announced_;
  std::uint32_t worlds_ = 0;
  std::uint64_t events_ = 0;
  std::optional<std::pair<Edition, Tick>> remembered_;     // the newest state of the history
  std::optional<std::pair<Edition, Tick>> newest_events_;  // of the frame with the newest events
};

}  // namespace troupe
