// RobotOutput: the topics that one robot publishes. A message is made only if its topic has a reader.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robot-agent/agent/gateway.h"
#include "robot-agent/ros/sensor_output.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/messages/names.h"
#include "ros/messages/odometry_error.h"
#include "ros/messages/robot_frames.h"
#include "ros/messages/robot_in_ros.h"
#include "ros/messages/ros_options.h"
#include "transport/dds/binding/wire.h"

namespace troupe {

class RobotOutput {
 public:
  // REQUIRES: the scene outlives the output.
  RobotOutput(const ros::RosNode& node, const ros::RobotTopics& settings, const Scene& scene, RobotId robot,
              const ros::RobotInRos& in_ros);

  // Adds the motion of a tick to the error of odometry. Once for each tick.
  void AddMotion(const RobotView& robot);
  // Publishes all topics except for the transforms.
  void Publish(Tick tick, const RobotView& robot);

  // Of the robot in its odometry frame, and of the links that its joints move.
  std::vector<ros::TransformStamped> MovingTransforms(Tick tick, const RobotView& robot, dds::WireArena& arena) const;
  // Of the sensors on their links; with plain names, of base_footprint; if the settings ask for it, of the odometry
  // frame in the map. `robot`: at the first tick.
  std::vector<ros::TransformStamped> StaticTransforms(const RobotView& robot, dds::WireArena& arena) const;

 private:
  struct Laser {
    ros::LaserTopic topic;
    std::unique_ptr<ros::RosWriter<ros::LaserScan>> writer;
  };
  struct Sonar {
    ros::SonarTopic topic;
    std::unique_ptr<ros::RosWriter<ros::RangeMessage>> writer;               // one of these two is
    std::unique_ptr<ros::RosWriter<ros::HumbleRangeMessage>> humble_writer;  // null, by distribution
    std::unique_ptr<ros::RosWriter<ros::PointCloud2>> points;
  };

  ros::Time Stamp(Tick tick) const;
  const RobotDescription& description() const { return scene_->world().robot(id_); }
  bool Due(Tick tick, std::size_t sensor) const;
  void PublishLaser(Tick tick, const RobotView& robot, Laser& laser);
  void PublishSonar(Tick tick, const RobotView& robot, Sonar& sonar);
  void PublishPoints(Tick tick, const RobotView& robot, Sonar& sonar);
  void PublishJoints(Tick tick, const RobotView& robot);
  void PublishBattery(Tick tick, const RobotView& robot);
  const Scene* scene_;
  RobotId id_;
  bool map_to_odom_;
  bool odom_to_base_;
  bool infinite_ranges_;
  ros::FrameNames frames_;
  ros::RobotFrames tree_;
  ros::OdometryError odometry_error_;
  ros::RosWriter<ros::OdometryMessage> odom_;
  ros::RosWriter<ros::OdometryMessage> ground_truth_;
  ros::RosWriter<ros::Bool> stalled_;
  std::unique_ptr<ros::RosWriter<ros::JointStateMessage>> joint_states_;  // null without joints
  std::unique_ptr<ros::RosWriter<ros::BatteryState>> battery_;            // null without energy
  ros::RosWriter<ros::String> robot_description_;
  std::vector<Laser> lasers_;
  std::vector<Sonar> sonars_;
  SensorOutput sensors_;
};

}  // namespace troupe
