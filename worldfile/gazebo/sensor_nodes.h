// The sensors of SDF models and of the `gazebo` elements of URDF as nodes of a world tree.
//
// Read: ray, gpu_ray, lidar and gpu_lidar (rays, planes, ranges, Gaussian noise), camera, depth and RGB-D cameras, imu,
// contact. Others are named in a warning. A sensor has the name of its topic, so that it has this topic in ROS, and the
// frame that its file names if its measurements are in that frame as they are here.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "worldfile/gazebo/rigid_model.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// Where a sensor is: in the frame B of the model that carries it, which is upright.
struct SensorAttachment {
  Transform3 T_BS;
  std::string link;                                 // that it is on
  const std::map<std::string, Transform3>* frames;  // in B, of the robot's file
};

std::optional<WorldNode> SensorNode(const SensorPart& sensor, const SensorAttachment& mount, Diagnostics& diagnostics);

}  // namespace troupe
