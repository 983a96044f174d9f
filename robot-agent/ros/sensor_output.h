// SensorOutput: the topics of a robot's cameras, fiducial finders and blobfinders, of its scanners with several planes,
// of its bumpers and contact sensors, and of its inertial measurement units. A message is made only if its topic has a
// reader and the sensor is due.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robot-agent/agent/gateway.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/messages/names.h"
#include "transport/dds/binding/wire.h"

namespace troupe {

class SensorOutput {
 public:
  // REQUIRES: the scene outlives the output.
  SensorOutput(const ros::RosNode& node, const Scene& scene, RobotId robot, const ros::FrameNames& frames);

  void Publish(const ros::Time& stamp, Tick tick, const RobotView& robot);
  // Of the frames of images on those of their cameras.
  void AddOpticalTransforms(const ros::Time& stamp, std::vector<ros::TransformStamped>& transforms,
                            dds::WireArena& arena) const;

 private:
  struct Camera {
    ros::KindTopic topic;
    std::unique_ptr<ros::RosWriter<ros::ImageMessage>> colors;
    std::unique_ptr<ros::RosWriter<ros::CameraInfo>> info;
    std::unique_ptr<ros::RosWriter<ros::ImageMessage>> depths;
    std::unique_ptr<ros::RosWriter<ros::CameraInfo>> depth_info;
  };
  struct Cloud {
    ros::CloudTopic topic;
    std::unique_ptr<ros::RosWriter<ros::PointCloud2>> writer;
  };
  struct Finder {
    ros::KindTopic topic;
    std::unique_ptr<ros::RosWriter<ros::Detection3dArray>> writer;
  };
  struct BlobOutput {
    ros::KindTopic topic;
    std::unique_ptr<ros::RosWriter<ros::Detection2dArray>> writer;
  };
  struct TouchOutput {
    ros::KindTopic topic;
    std::unique_ptr<ros::RosWriter<ros::Bool>> writer;
  };

  struct ImuOutput {
    ros::KindTopic topic;
    std::unique_ptr<ros::RosWriter<ros::ImuMessage>> writer;
  };

  bool Due(Tick tick, std::size_t sensor) const;
  std::string OpticalFrame(const Camera& camera) const { return prefix_ + camera.topic.frame + "_optical"; }
  void PublishCamera(const ros::Time& stamp, const RobotView& robot, Camera& camera);

  const Scene* scene_;
  RobotId id_;
  std::string prefix_;  // of frames
  std::vector<Camera> cameras_;
  std::vector<Cloud> clouds_;
  std::vector<Finder> finders_;
  std::vector<BlobOutput> blobfinders_;
  std::vector<TouchOutput> touches_;
  std::vector<ImuOutput> imus_;
};

}  // namespace troupe
