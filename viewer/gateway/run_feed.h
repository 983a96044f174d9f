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

#include "common/protocol/transport.h"
#include "common/spatial/scene.h"

namespace troupe {

// The world of an edition, prepared for viewers.
struct ViewedWorld {
  std::uint32_t number = 0;  // counts the worlds of a feed from 1
  RunId run = 0;
  Edition edition = 0;                         // world_edition of its frames
  std::shared_ptr<const std::string> message;  // EncodeWorld
  std::shared_ptr<const Scene> scene;
};

struct NumberedEvent {
  std::uint64_t number = 0;  // counts the events of a feed from 1
  Event event;
};

// A copy of the newest content of a feed.
struct FeedContent {
  std::uint64_t version = 0;                 // of everything below; 0: nothing yet
  std::shared_ptr<const ViewedWorld> world;  // null: no run was found yet, or it has ended
  WorldState state;                          // of that world
  std::uint64_t state_hash = 0;
  Edition edition = 0;
  bool paused = false;
  bool last = false;  // the run has ended in order
  std::optional<StatusMessage> status;
  std::deque<NumberedEvent> events;  // the newest of the run, at most RunFeed::kEventsKept
};

class RunFeed : public ObserverHandler {
 public:
  static constexpr std::size_t kEventsKept = 500;

  // Copies the content to `content` unless it has the same version already.
  void Read(FeedContent& content) const;
  // The service has ended since the last call.
  bool ConsumeServiceGone();
  // Forgets the run, unless it has ended in order: its end stays in view. REQUIRES: no handler call runs.
  void Clear();

  void OnSession(const SessionMessage& session) override;
  void OnFrame(const FrameMessage& frame) override;
  void OnStatus(const StatusMessage& status) override;
  void OnServiceGone() override;

 private:
  void AddEvents(const FrameMessage& frame);

  mutable std::mutex mutex_;  // guards content_ and service_gone_
  FeedContent content_;
  bool service_gone_ = false;
  // Of the newest session: the world of the frames that follow.
  std::shared_ptr<const ViewedWorld> announced_;
  std::uint32_t worlds_ = 0;
  std::uint64_t events_ = 0;
  std::optional<std::pair<Edition, Tick>> newest_events_;  // of the frame with the newest events
};

}  // namespace troupe
