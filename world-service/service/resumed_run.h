// ResumedRun: a run that another service has begun, at its newest committed state, for the service that continues it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/spatial/scene.h"
#include "transport/protocol/messages.h"
#include "transport/protocol/run_progress.h"

namespace troupe {

// A rewind within which a service died: some of the states on the way to its tick are missing.
struct UnfinishedRewind {
  ControlRequest request;
  std::uint64_t number = 0;  // of the state with which the robots begin anew
  Edition copied_from = 0;   // of that state, when the robots began with it the first time
  std::uint64_t copies = 0;  // number of the states that follow, copies of earlier ones
};

struct ResumedRun {
  RunId run = 0;
  bool is_branch = false;                 // a new run, which begins with a state of a recorded one
  Incarnation incarnation = 0;            // of the service that continues
  std::shared_ptr<const Scene> original;  // that a reset restores
  std::shared_ptr<const Scene> scene;     // of the newest state
  std::optional<FrameMessage> frame;      // with the newest state; nothing: the run had not begun
  std::optional<MemoryPlace> previous;    // the state before; nothing: there is none
  std::uint64_t next_number = 0;          // of the state after it, counted from the begin of the run
  RunProgress progress;
  std::optional<UnfinishedRewind> rewind = {};  // must be finished before the run continues
  std::string world_file;                       // that was loaded during the run; empty: none
};

}  // namespace troupe
