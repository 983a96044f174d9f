// SavePicture: a picture of a state of a world, as a file.
#pragma once

#include <string>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "troupe/picture_options.h"
#include "troupe/result.h"
#include "troupe/simulation.h"
#include "troupe/world_state.h"

namespace troupe {

// As Simulation::SavePicture. REQUIRES: `bodies` is at `state`.
Status SavePicture(const Scene& scene, const BodyIndex& bodies, const WorldState& state, const std::string& file,
                   const PictureOptions& options, PictureRays rays);

}  // namespace troupe
