// SavePicture: a picture of a state of a world, as a file.
#pragma once

#include <string>

#include "common/base/result.h"
#include "common/model/world_state.h"
#include "common/picture/picture_options.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "troupe/simulation.h"

namespace troupe {

// As Simulation::SavePicture. REQUIRES: `bodies` is at `state`.
Status SavePicture(const Scene& scene, const BodyIndex& bodies, const WorldState& state, const std::string& file,
                   const PictureOptions& options, PictureRays rays);

}  // namespace troupe
