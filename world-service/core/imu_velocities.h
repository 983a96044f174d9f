// The velocities of inertial measurement units, which a state keeps for the accelerations of the next one. Private to
// this folder.
#pragma once

#include <optional>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"

namespace troupe {

// Keeps the present velocities in `state.imus`: of all units, or of those of one robot.
// REQUIRES: `bodies` is an index of `scene` at `state`.
void KeepVelocities(const Scene& scene, const BodyIndex& bodies, WorldState& state,
                    std::optional<RobotId> robot = std::nullopt);

// The same after an edit of a robot, so that its units measure no acceleration by it.
void KeepVelocities(const Scene& scene, RobotId robot, WorldState& state);

}  // namespace troupe
