// RobotMemories: which states of the past an agent that joins is missing.
//
// A state of the world is not all that the next proposals depend on: controllers, odometry and grippers of a robot have
// a memory, which lives in its agent only and is not recorded. It can be made again by having a new agent process the
// states since the robot's fresh start, which RunHistory reads.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "transport/protocol/messages.h"
#include "world-service/service/run_history.h"

namespace troupe {

// Compares the memory of the robots of an agent that joins with the states of a run.
//
// The memory of a robot (its controller, odometry and grippers) depends on the states since it was made: at the newest
// fresh start (edition `fresh_edition` of frames), or when it was spawned since.
class RobotMemories {
 public:
  // A state is committed: by a step, by an edit in the pause at `before`, or by a rewind that ends behind `previous`.
  void OnStep(const FrameMessage& frame) { previous_ = {frame.edition, frame.state.tick - 1, true}; }
  void OnEdit(const FrameMessage& frame, Tick before) { previous_ = {frame.edition - 1, before, false}; }
  void OnRewind(const std::optional<ControllerCheckpoint>& previous) { previous_ = previous; }
  // A run is continued: robots that were spawned since the fresh start count as made then.
  void Resume(const std::optional<ControllerCheckpoint>& previous, Edition fresh_edition) {
    previous_ = previous;
    fresh_edition_ = fresh_edition;
  }
  // An edit has added robots, or made all of them anew.
  void OnNewRobots(const std::vector<std::string>& robots, Edition edition);
  void OnFreshStart(Edition edition);

  // The history that the agent needs before it can answer the newest frame; nothing: its memory reaches up to there.
  std::optional<HistoryRequest> MissingFor(const JoinMessage& join, const FrameMessage& newest) const;
  // No state but the newest one is to be remembered since the fresh start.
  bool IsFirstOf(Edition edition, const FrameMessage& newest) const {
    return newest.edition == edition && (!previous_ || previous_->edition < edition);
  }

 private:
  std::optional<ControllerCheckpoint> previous_;  // the state before the newest; nothing: there is none
  Edition fresh_edition_ = 0;                     // of all robots but these:
  std::map<std::string, Edition> spawned_;        // robots that were added since, and when
};

}  // namespace troupe
