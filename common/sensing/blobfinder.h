// The blobfinder: stretches of one colour in a row of horizontal rays, one for each column of its image. The first body
// of each ray counts, whatever its returns; its upper and lower edges are those of the block at the finder's height.
#pragma once

#include <memory>

#include "common/sensing/sensor.h"

namespace troupe {

// REQUIRES: the description has BlobfinderParameters.
std::unique_ptr<const Sensor> MakeBlobfinder(const SensorMount& mount);

}  // namespace troupe
