// RobotOutput: the topics that one robot publishes. Nothing is made for a topic that nobody reads.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/dds/wire.h"
#include "common/ros/names.h"
#include "common/ros/odometry_error.h"
#include "common/ros/robot_frames.h"
#include "common/ros/ros_options.h"
#include "common/ros_dds/ros_endpoints.h"
#include "robot-agent/agent/gateway.h"

namespace troupe {

class RobotOutput {
 public:
  // The scene must outlive it. `name`: the robot's in ROS.
  RobotOutput(const ros::RosNode& node, const ros::RosOptions& options, const Scene& scene, RobotId robot,
              const std::string& name);

  // All but the transforms.
  void Publish(Tick tick, const RobotView& robot);

  // From the odometry frame to the robot, and of what its joints move, now.
  std::vector<ros::TransformStamped> MovingTransforms(Tick tick, const RobotView& robot, dds::WireArena& arena) const;
  // Of the sensors on what they are mounted on, and of the odometry frame in the map if the options say so. `robot`: at
  // the first tick.
  std::vector<ros::TransformStamped> StaticTransforms(const RobotView& robot, dds::WireArena& arena) const;

 private:
  struct Laser {
    ros::LaserTopic topic;
    std::unique_ptr<ros::RosWriter<ros::LaserScan>> writer;
  };
  struct Sonar {
    ros::SonarTopic topic;
    std::unique_ptr<ros::RosWriter<ros::RangeMessage>> writer;               // one of these two
    std::unique_ptr<ros::RosWriter<ros::HumbleRangeMessage>> humble_writer;  // is not null
    std::unique_ptr<ros::RosWriter<ros::PointCloud2>> points;
  };

  ros::Time Stamp(Tick tick) const;
  const RobotDescription& description() const { return scene_->world().robot(id_); }
  bool Due(Tick tick, std::size_t ranger) const;
  void PublishLaser(Tick tick, const RobotView& robot, Laser& laser);
  void PublishSonar(Tick tick, const RobotView& robot, Sonar& sonar);
  void PublishPoints(Tick tick, const RobotView& robot, Sonar& sonar);
  void PublishJoints(Tick tick, const RobotView& robot);
  const Scene* scene_;
  RobotId id_;
  bool map_to_odom_;
  ros::FrameNames frames_;
  ros::RobotFrames tree_;
  ros::OdometryError odometry_error_;
  ros::RosWriter<ros::OdometryMessage> odom_;
  ros::RosWriter<ros::OdometryMessage> ground_truth_;
  ros::RosWriter<ros::Bool> stalled_;
  ros::RosWriter<ros::JointStateMessage> joint_states_;
  ros::RosWriter<ros::String> robot_description_;
  std::vector<Laser> lasers_;
  std::vector<Sonar> sonars_;
};

}  // namespace troupe
