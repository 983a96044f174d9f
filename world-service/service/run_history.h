// The states of a run so far: for agents whose robots need the memory of them, for a rewind, and for a service that
// continues a run.
//
// A state of the world is not all that the next proposals depend on: controllers, odometry and grippers of a robot have
// a memory, which lives in its agent only and is not recorded. It can be made again by having a new agent process the
// states since the robot's fresh start. So this file has three parts: RunHistory (reading the states from a recording
// or a journal), RobotMemories (which states an agent that joins is missing) and Rewind (setting a run back, which is
// the same for all robots at once).
//
// Positions in the past are ControllerCheckpoints: an edition, a tick, and whether the robots decided on the state or
// it was only published in a pause. Ticks alone are ambiguous, because an edit makes another state of the same tick.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "transport/protocol/messages.h"
#include "transport/protocol/run_progress.h"
#include "troupe/result.h"

namespace troupe {

// A request for states of the past.
struct HistoryRequest {
  std::optional<ControllerCheckpoint> after = {};  // those that follow this one
  Edition from = 0;                                // without `after`: those from the first of this edition on
  bool operator==(const HistoryRequest&) const = default;
};

// A run that was set back to an earlier tick.
struct RewoundRun {
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const Scene> original;         // of the world that a reset restores
  FrameMessage frame;                            // the state, its hash and the editions
  std::optional<ControllerCheckpoint> previous;  // the state before it; nothing: it is the first since the fresh start
};

// The states with which a run is set back to an earlier tick: that with which the robots of that time were rebuilt,
// as the result of the request, which is an edit, then those of the steps and edits up to the tick.
class RewindStates {
 public:
  virtual ~RewindStates() = default;
  // Makes some of them from the recording, and writes nothing. False: all are made.
  virtual Result<bool> MakeSome() = 0;
  // Appends all of them to the recording, behind the newest state. After an error the recording gets no further state,
  // and its recorder ends the run. REQUIRES: all are made.
  virtual Result<RewoundRun> Write() = 0;
};

// Reads the states, which may be slow. Called on one thread at a time.
class RunHistory {
 public:
  virtual ~RunHistory() = default;
  // Some of the states, in order and without a gap, and without the newest of the run: another one follows each. Their
  // frames have no run. At least one, or an error.
  virtual Result<std::vector<HistoryEntry>> Read(const HistoryRequest& request) = 0;
  // For the last state of the request's tick. `newest`: the newest state of the run, which waits. The error is a tick
  // that the recording does not have.
  virtual Result<std::unique_ptr<RewindStates>> StartRewind(const control::Rewind& request,
                                                            const FrameMessage& newest) = 0;
};

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
  std::shared_ptr<const WorldDescription> entity;  // a world with it alone
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

// Rewind: sets a run back to an earlier tick, in a quiescent pause that lasts until it is finished.
//
//   kNone --Start--> kMaking --all states are made--> kWriting --all are written--> kNone: the run is set back
//                       |                                |
//                       +--error, or the run ends        +--error--> kNone: the recorder ends the run
//                       +-----------------------> kNone: the run is as before, and so is its recording
//
// So a recording has a whole rewind or nothing of it, and a run that is stopped waits for no more than the writing.
//
// A service that dies leaves this in the journal, and the next one does:
//   kMaking                          nothing: the run is as before, and the request is unknown
//   kWriting, before the first state likewise
//   kWriting, or until the commit    RunProgress::is_rewinding, without commands and inputs, and the states so far: it
//   of the end (WorldEditor::Rewind) writes the rest and commits the end, before its agents join (UnfinishedRewind)
//   after the commit                 an edit like others; agents are sent the states since the robots began again
// Other requests wait from Start to the end (RunControl), so that none changes what is dropped.
class Rewind {
 public:
  enum class Stage : std::uint8_t {
    kNone,
    kMaking,   // the states, from the recording; nothing is written
    kWriting,  // to the recording, which nothing interrupts
  };
  Stage stage() const { return stage_; }
  bool is_running() const { return stage_ != Stage::kNone; }

  // `newest`: the state of the run. REQUIRES: is_running() is false.
  void Start(const control::Rewind& request, const FrameMessage& newest);

  // Works for some ms, or until all states are written. The only call that may be made without the lock of the run:
  // while it lasts, only stage() and is_running() may be called. REQUIRES: is_running().
  void Work(RunHistory& history);

  // The transition after Work. The outcome, with which the rewind has ended; nothing: it is still running. `run_ends`:
  // states that are not written are dropped.
  std::optional<Result<RewoundRun>> Advance(bool run_ends);

 private:
  Result<bool> MakeSome(RunHistory& history);

  Stage stage_ = Stage::kNone;
  control::Rewind request_;
  FrameMessage newest_;
  std::unique_ptr<RewindStates> states_;       // null: not started
  Result<bool> has_more_ = true;               // states to be made
  std::optional<Result<RewoundRun>> written_;  // the outcome of kWriting
};

}  // namespace troupe
