// SaveView: the image of a camera, as a file.
#pragma once

#include <string>

#include "troupe/result.h"
#include "troupe/simulation.h"

namespace troupe {

// As Simulation::SaveView.
Status SaveView(const CameraReading& reading, const std::string& file, CameraImage image);

}  // namespace troupe
