// RobotOutput: the topics that one robot publishes. A message is made only if its topic has a reader.
// With thousands of robots most topics have no reader, and the making of scans and images is the cost. Stamps are
// simulated time, of the tick whose state is shown; frames are those of REP 105. In a pause only new readers are
// addressed (addresses_newcomers), which would otherwise wait for the next tick. Called by the agent's thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot-agent/agent/gateway.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/messages/convert.h"
#include "ros/messages/names.h"
#include "ros/messages/robot_frames.h"
#include "ros/messages/ros_options.h"
#include "transport/dds/binding/wire.h"

namespace troupe {

// SensorOutput: the topics of a robot's cameras, fiducial finders and blobfinders, of its scanners with several planes,
// of its bumpers and contact sensors, and of its inertial measurement units. A message is made only if its topic has a
// reader and the sensor is due.
class SensorOutput {
 public:
  // REQUIRES: the scene outlives the output.
  SensorOutput(const ros::RosNode& node, const Scene& scene, RobotId robot, const ros::FrameNames& frames);

  void Publish(const ros::Time& stamp, Tick tick, const RobotView& robot);
  // Adds the transforms of the frames of images on the frames of their cameras.
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
  template <typename Message, typename Topic = ros::KindTopic>
  struct Output {
    Topic topic;
    std::unique_ptr<ros::RosWriter<Message>> writer;
  };
  using Cloud = Output<ros::PointCloud2, ros::CloudTopic>;
  using Finder = Output<ros::Detection3dArray>;
  using BlobOutput = Output<ros::Detection2dArray>;
  using TouchOutput = Output<ros::Bool>;
  using ImuOutput = Output<ros::ImuMessage>;

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

class RobotOutput {
 public:
  // REQUIRES: the scene outlives the output.
  RobotOutput(const ros::RosNode& node, const ros::RobotTopics& settings, const Scene& scene, RobotId robot,
              const ros::RobotInRos& in_ros);

  // Adds the motion of a tick to the error of odometry. Once for each tick.
  void AddMotion(const RobotView& robot);
  // Publishes all topics except for the transforms.
  void Publish(Tick tick, const RobotView& robot);

  // The transforms of the robot in its odometry frame, and of the links that its joints move.
  // Empty if they are equal to the last call's, as after an edit that left the robot as it was: tf2 takes a repeated
  // stamp for an error.
  std::vector<ros::TransformStamped> MovingTransforms(Tick tick, const RobotView& robot, dds::WireArena& arena);
  // The transforms of the sensors on their links; with plain names, of base_footprint; if the settings ask for it, of
  // the odometry frame in the map. `robot`: at the first tick.
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

  struct Motion {
    Tick tick = 0;
    Pose estimate;
    Twist twist;

    bool operator==(const Motion&) const = default;
  };

  ros::Time Stamp(Tick tick) const;
  // Whether readers lack a message of this motion, of which `last` is the last one.
  bool IsNew(std::optional<Motion>& last, Tick tick, const RobotView& robot) const;
  const RobotDescription& description() const { return scene_->world().robot(id_); }
  bool Due(Tick tick, std::size_t sensor) const;
  void PublishLaser(Tick tick, const RobotView& robot, Laser& laser);
  void PublishSonar(Tick tick, const RobotView& robot, Sonar& sonar);
  void PublishPoints(Tick tick, const RobotView& robot, Sonar& sonar);
  void PublishJoints(Tick tick, const RobotView& robot);
  void PublishBattery(Tick tick, const RobotView& robot);

  const ros::RosConnection& connection_;
  const Scene* scene_;
  RobotId id_;
  std::optional<Motion> last_odometry_;
  std::optional<Motion> last_transforms_;
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
