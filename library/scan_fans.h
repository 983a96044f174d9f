// The readings of sensors as the fans and marks of a picture.
#pragma once

#include <vector>

#include "common/picture/draw_picture.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "troupe/world_state.h"

namespace troupe {

// The readings of all rangers of all robots. REQUIRES: `bodies` is at `state`.
std::vector<ScanFan> MeasureFans(const Scene& scene, const BodyIndex& bodies, const WorldState& state);

// The marks of the readings of all other sensors of all robots, likewise.
std::vector<Mark> MeasureMarks(const Scene& scene, const BodyIndex& bodies, const WorldState& state);

}  // namespace troupe
