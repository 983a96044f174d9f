// The states of a rewind (world-service/service/rewind.h), made from the recording of the run and appended to all
// recordings that it writes: by the service that was asked, or by the one that continues after its death.
//
// The first is the one with which the robots of the tick began, as the result of an edit that replaces the world; the
// others are copies of those that followed it up to the tick. They keep their ticks and hashes, and get the next
// editions, because editions of a run never decrease. The agents make the memory of their robots from them.
#pragma once

#include <memory>
#include <vector>

#include "transport/protocol/messages.h"
#include "troupe/result.h"
#include "world-service/observers/recorder/run_recorder.h"
#include "world-service/service/resumed_run.h"
#include "world-service/service/run_history.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// For the last state of the request's tick. `recorders`: of the run, not empty; they outlive the states. `newest`: the
// newest state of the run. The error is a tick that the recording does not have.
Result<std::unique_ptr<RewindStates>> StartRewind(const std::vector<RunRecorder*>& recorders,
                                                  const control::Rewind& request, const FrameMessage& newest);

// Writes the rest of `run.rewind`, whose end the service before did not commit, commits it, and sets `run` to its end.
// `observers`: besides the recorder, which continues the journal of the run.
Status FinishRewind(ResumedRun& run, RunRecorder& recorder, RunObservers observers);

}  // namespace troupe
