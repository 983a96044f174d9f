// Pure functions from the readings of cameras and of scanners with several planes to ROS messages.
#pragma once

#include <string>

#include "common/dds/binding/wire.h"
#include "common/ros/messages.h"
#include "troupe/sensor.h"

namespace troupe::ros {

// Red, green and blue of each pixel, encoding "rgb8".
ImageMessage MakeColorImage(const Time& stamp, const std::string& frame, const CameraReading& reading,
                            dds::WireArena& arena);

// Depths in metres, encoding "32FC1": -Inf below the camera's range, +Inf beyond it (REP 117, REP 118).
ImageMessage MakeDepthImage(const Time& stamp, const std::string& frame, const CameraReading& reading,
                            dds::WireArena& arena);

// The camera's optics, without distortion.
CameraInfo MakeCameraInfo(const Time& stamp, const std::string& frame, const CameraReading& reading,
                          dds::WireArena& arena);

// From a camera's frame, which looks along x, to that of its images: z ahead, x to the right (REP 103).
TransformStamped MakeOpticalTransform(const Time& stamp, const std::string& camera, const std::string& optical,
                                      dds::WireArena& arena);

// The hits of a scan in its own frame, with their intensities: fields x, y, z and intensity.
PointCloud2 MakeScanCloud(const Time& stamp, const std::string& frame, const RangeScan& scan, dds::WireArena& arena);

}  // namespace troupe::ros
