// ResumedRun: the end of a run that another service has begun, or of the part of a recording that a branch continues.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "common/spatial/scene.h"
#include "transport/protocol/messages.h"
#include "transport/protocol/run_progress.h"

namespace troupe {

// A rewind that a service has begun to write, and died before it committed the end: some of its states may be missing.
struct UnfinishedRewind {
  control::Rewind request;
  std::uint64_t number = 0;                        // of the state with which the robots begin again
  Edition copied_from = 0;                         // of that state, when the robots began with it the first time
  std::uint64_t copies = 0;                        // number of the states that follow, copies of earlier ones
  std::shared_ptr<const Scene> scene_before = {};  // of the state that the run was set back from; null: unknown
};

// An entity that a request has deleted, and another one may restore.
struct DeletedEntity {
  std::string name;
  std::shared_ptr<const WorldDescription> entity;  // a world with it alone; null: a person, whose goals are the world's
};
inline constexpr std::size_t kMaxDeleted = 100;

// A run that another service has begun, at its newest committed state, for the service that continues it.
struct ResumedRun {
  RunId run = 0;
  bool is_branch = false;                        // a new run, which begins with a state of a recorded one
  Incarnation incarnation = 0;                   // of the service that continues
  std::shared_ptr<const Scene> original;         // that a reset restores
  std::shared_ptr<const Scene> scene;            // of the newest state
  std::optional<FrameMessage> frame;             // with the newest state; nothing: the run had not begun
  std::optional<ControllerCheckpoint> previous;  // the state before; nothing: there is none
  std::uint64_t next_number = 0;                 // of the state after it, counted from the start of the run
  RunProgress progress;
  std::optional<UnfinishedRewind> rewind = {};  // must be finished before the run continues
  std::optional<std::string> world_file = {};   // that was loaded during the run, empty for no world
  std::deque<DeletedEntity> deleted = {};       // the newest last, at most kMaxDeleted
};

}  // namespace troupe
