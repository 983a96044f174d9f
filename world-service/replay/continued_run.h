// The past from which a service goes on (ResumedRun): the state at the end of it, and what later requests need beyond
// the state, as the entities that were deleted and the file of the world.
//
// BranchRun: a new run that begins with the state of a recorded one at some tick, as recorded or with changes. It has a
// run id, a recording and a summary of its own. Its recording contains the states of the source up to the branch, so
// that it replays without the source, and the changes as an edit of their own (control::Change): so a branch without
// changes has the hashes of its source, and one with changes replays without the command line that made it.
//
// RestoreRun: the run of a service that has died, at its newest state. The run id remains, and the incarnation is one
// more. A rewind within which the service died is finished by FinishRewind (journal_rewind.h).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/run/run_settings.h"
#include "common/spatial/scene.h"
#include "recording/journal.h"
#include "troupe/result.h"
#include "world-service/observers/recorder/run_recorder.h"
#include "world-service/service/resumed_run.h"
#include "world-service/service/run_observer.h"

namespace troupe {

struct BranchOptions {
  std::optional<Tick> from;  // nothing: the last tick
  std::optional<std::uint64_t> seed;
  // "CONTROLLER" of the idle robots, or "ROBOT=CONTROLLER", each with ":{...}", its parameters, if it has any.
  std::vector<std::string> controllers;
  RunOverrides run;  // of the recorded settings
  bool paused = false;
};

struct BranchedRun {
  RunSettings settings;
  ResumedRun resumed;
  std::shared_ptr<const RecordedStart> begin;  // of its own recording
};

// One of BranchOptions::controllers.
struct ControllerChange {
  std::string robot;  // empty: the idle ones
  ControllerDescription controller;
};
Result<ControllerChange> ParseControllerChange(const std::string& text);

// The error is a file that is no recording of this version of the step, a tick that it does not have, or an unknown
// robot.
Result<BranchedRun> BranchRun(const std::string& file, const BranchOptions& options);

// The observers of the ticks of a run, with the world that it began with.
using MakeRunObservers = std::function<Result<RunObservers>(const std::shared_ptr<const Scene>& first)>;

// Steps from the last keyframe to the newest tick, and compares every state hash. With observers it steps from the
// start of the recording, and reports each tick of the run to them, without those before it if it continues another
// one: they then have written the same as if the run had not been interrupted. Their OnBegin and OnEnd are not called.
// The error is a journal of another version of the step, damage, or the error of an observer.
Result<ResumedRun> RestoreRun(const Journal& journal, const MakeRunObservers& make_observers);

}  // namespace troupe
