// Running a world up to a tick inside this process, without agents and messages: the same robots decide and the same
// step moves them, so the state is that of any other run in lockstep.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/model/world_state.h"
#include "common/picture/draw_picture.h"
#include "common/spatial/scene.h"

namespace troupe {

// The state at `tick`. `failures` gets a line for each controller that failed on the way; its robot stands still from
// then on. The error is a controller that cannot be made; none is made for tick 0.
Result<WorldState> RunToTick(const Scene& scene, Tick tick, std::vector<std::string>& failures);

// What all rangers of all robots measure in this state, ready to be drawn.
std::vector<ScanFan> MeasureFans(const Scene& scene, const WorldState& state);

}  // namespace troupe
