// The camera: an image of colours, depths and models. The image plane is vertical, so that each column of the image is
// a half plane of the world (column_cast.h), in which every pixel is exact: sides, tops and undersides of blocks, and
// the ground at z 0. A camera that looks up or down is one with a shifted lens: verticals stay vertical.
#pragma once

#include <memory>

#include "common/sensing/sensor.h"

namespace troupe {

// REQUIRES: the description has CameraParameters.
std::unique_ptr<const Sensor> MakeCamera(const SensorMount& mount);

}  // namespace troupe
