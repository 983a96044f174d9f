// RestoreRun: the newest state of a run, from its journal.
#pragma once

#include <optional>

#include "recording/journal.h"
#include "troupe/result.h"
#include "world-service/service/run_history.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// Steps from the last keyframe to the newest tick, and compares every state hash. With observers it steps from the
// start of the run, and reports each tick to them: they then have written the same as if the run had not been
// interrupted. Their OnBegin and OnEnd are not called. The error is a journal of another version of the step, damage,
// or the error of an observer.
Result<ResumedRun> RestoreRun(const Journal& journal, const RunObservers& observers);

// The state before a recorded one; nothing: there is none.
std::optional<MemoryPlace> PreviousOf(const RecordedTick& tick);

}  // namespace troupe
