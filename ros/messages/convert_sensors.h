// Pure functions from the readings of cameras, finders and scanners with several planes to ROS messages.
#pragma once

#include <string>

#include "ros/messages/messages.h"
#include "transport/dds/binding/wire.h"
#include "troupe/sensor.h"
#include "troupe/world_description.h"

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

// The fiducials in the finder's frame: of each a box of its model's size, its id as the class, and the name of the
// model as the id for tracking.
Detection3dArray MakeFiducialDetections(const Time& stamp, const std::string& frame, const WorldDescription& world,
                                        const FiducialReading& reading, dds::WireArena& arena);

// The IMU's measurement in its own frame; its heading is in the world. Roll and pitch, and their rates, are 0 exactly.
ImuMessage MakeImuMessage(const Time& stamp, const std::string& frame, const ImuReading& reading,
                          dds::WireArena& arena);

// The blobs in pixels: of each its colour as the class, "#rrggbb", and the place at its range in the direction of its
// middle as the pose, in the blobfinder's frame.
Detection2dArray MakeBlobDetections(const Time& stamp, const std::string& frame, const BlobfinderReading& reading,
                                    dds::WireArena& arena);

}  // namespace troupe::ros
