// Break beams: which object stands in the light across a gripper's gap.
#pragma once

#include <optional>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"

namespace troupe {

// By beam of `gripper`: the object nearest to its first end that is in it (of equals the lowest id), held or not, in
// the state that `bodies` holds. Only objects break beams.
void MeasureBeams(const Scene& scene, const BodyIndex& bodies, GripperId gripper,
                  std::vector<std::optional<ObjectId>>& broken_by);

}  // namespace troupe
