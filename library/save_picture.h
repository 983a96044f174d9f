// Pictures of a state as files: of the world (PNG or SVG), and of the view of a camera (PNG).
//
// A picture with rays measures all sensors again on the state: readings are functions of the state, so that the picture
// shows what the robots have read, and measuring for a picture changes nothing. The robots, the index and the state are
// the caller's; nothing is kept between calls. The cost is that of all sensors of all robots, or without rays that of
// drawing.
#pragma once

#include <string>
#include <vector>

#include "common/picture/draw_picture.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "troupe/picture_options.h"
#include "troupe/result.h"
#include "troupe/simulation.h"
#include "troupe/world_state.h"

namespace troupe {

// DrawPicture: as Simulation::DrawPicture. REQUIRES: `bodies` is at `state`.
Result<std::string> DrawPicture(const Scene& scene, const BodyIndex& bodies, const WorldState& state,
                                const PictureOptions& options, PictureRays rays);

// SavePicture: a picture of a state of a world, as a file.
// As Simulation::SavePicture. REQUIRES: `bodies` is at `state`.
Status SavePicture(const Scene& scene, const BodyIndex& bodies, const WorldState& state, const std::string& file,
                   const PictureOptions& options, PictureRays rays);

// SaveView: the image of a camera, as a file.
// As Simulation::SaveView.
Status SaveView(const CameraReading& reading, const std::string& file, CameraImage image);

// The readings of sensors as the fans and marks of a picture.

// The readings of all rangers of all robots. REQUIRES: `bodies` is at `state`.
std::vector<ScanFan> MeasureFans(const Scene& scene, const BodyIndex& bodies, const WorldState& state);

// The marks of the readings of all other sensors of all robots, on the same terms.
std::vector<Mark> MeasureMarks(const Scene& scene, const BodyIndex& bodies, const WorldState& state);

}  // namespace troupe
