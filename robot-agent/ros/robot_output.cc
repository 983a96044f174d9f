#include "robot-agent/ros/robot_output.h"

#include "ros/connection/ros_qos.h"
#include "ros/messages/convert.h"
#include "ros/messages/robot_description.h"

namespace troupe {
namespace {

constexpr std::int32_t kOutputDepth = 10;

// REQUIRES: sensor `ranger` is a ranger.
const std::vector<RangeScan>& ScansOf(const RobotView& robot, std::size_t ranger) {
  return std::get<RangerReading>(robot.Measure(ranger).content).scans;
}

}  // namespace

RobotOutput::RobotOutput(const ros::RosNode& node, const ros::RobotTopics& settings, const Scene& scene, RobotId robot,
                         const ros::RobotInRos& in_ros)
    : scene_(&scene),
      id_(robot),
      map_to_odom_(settings.map_to_odom),
      odom_to_base_(settings.odom_to_base),
      infinite_ranges_(settings.infinite_ranges.value_or(true)),
      frames_(in_ros.frames),
      tree_(ros::RobotFramesOf(scene, robot, frames_)),
      odometry_error_(description().localization),
      odom_(node, "odom", ros::Stream(kOutputDepth)),
      ground_truth_(node, "ground_truth", ros::Stream(kOutputDepth)),
      stalled_(node, "stalled", ros::Stream(kOutputDepth)),
      robot_description_(node, "robot_description", ros::Latched()),
      sensors_(node, scene, robot, frames_) {
  if (!tree_.moving.empty()) {
    joint_states_ =
        std::make_unique<ros::RosWriter<ros::JointStateMessage>>(node, "joint_states", ros::Stream(kOutputDepth));
  }
  if (scene.store_of(description().root)) {
    battery_ = std::make_unique<ros::RosWriter<ros::BatteryState>>(node, "battery", ros::Stream(kOutputDepth));
  }
  dds::WireArena arena;
  robot_description_.Write({arena.Copy(ros::MakeRobotDescription(scene, robot, in_ros.name, frames_))});
  const ros::SensorTopics topics = ros::SensorTopicsOf(description());
  for (const ros::LaserTopic& topic : topics.lasers) {
    lasers_.push_back(
        {topic, std::make_unique<ros::RosWriter<ros::LaserScan>>(node, topic.topic, ros::Stream(kOutputDepth))});
  }
  for (const ros::SonarTopic& topic : topics.sonars) {
    // All sensors of a ranger share the topic.
    const ros::TopicQos qos = ros::Stream(kOutputDepth * static_cast<std::int32_t>(topic.sensors.size()));
    Sonar sonar{topic, nullptr, nullptr, nullptr};
    sonar.points =
        std::make_unique<ros::RosWriter<ros::PointCloud2>>(node, topic.topic + "/points", ros::Stream(kOutputDepth));
    if (node.connection->distribution() == ros::Distribution::kHumble) {
      sonar.humble_writer = std::make_unique<ros::RosWriter<ros::HumbleRangeMessage>>(node, topic.topic, qos);
    } else {
      sonar.writer = std::make_unique<ros::RosWriter<ros::RangeMessage>>(node, topic.topic, qos);
    }
    sonars_.push_back(std::move(sonar));
  }
}

ros::Time RobotOutput::Stamp(Tick tick) const {
  return ros::ToTime(tick, scene_->world().interval_ns);
}

bool RobotOutput::Due(Tick tick, std::size_t sensor) const {
  return tick % description().sensors[sensor].period_ticks == 0;
}

void RobotOutput::AddMotion(const RobotView& robot) {
  odometry_error_.AddMotion(robot.state().twist, scene_->world().interval_seconds());
}

void RobotOutput::Publish(Tick tick, const RobotView& robot) {
  const RobotState& state = robot.state();
  if (odom_.is_addressed()) {
    dds::WireArena arena;
    odom_.Write(ros::MakeOdometry(Stamp(tick), frames_.odom, frames_.base, robot.pose_estimate(), state.twist,
                                  odometry_error_.covariance(), arena));
  }
  if (ground_truth_.is_addressed()) {
    dds::WireArena arena;
    ground_truth_.Write(
        ros::MakeOdometry(Stamp(tick), ros::kMapFrame, frames_.base, state.X_WR, state.twist, {}, arena));
  }
  if (stalled_.is_addressed()) stalled_.Write({state.stalled});
  for (Laser& laser : lasers_) PublishLaser(tick, robot, laser);
  for (Sonar& sonar : sonars_) {
    PublishSonar(tick, robot, sonar);
    PublishPoints(tick, robot, sonar);
  }
  sensors_.Publish(Stamp(tick), tick, robot);
  if (joint_states_ && joint_states_->is_addressed()) PublishJoints(tick, robot);
  if (battery_ && battery_->is_addressed()) PublishBattery(tick, robot);
}

void RobotOutput::PublishPoints(Tick tick, const RobotView& robot, Sonar& sonar) {
  const std::size_t ranger = sonar.topic.ranger;
  if (!sonar.points->is_addressed() || !Due(tick, ranger)) return;
  const std::vector<RangeScan>& scans = ScansOf(robot, ranger);
  std::vector<Pose> poses;
  std::vector<double> ranges;
  std::vector<double> limits;
  for (const ros::SonarTopic::Sensor& sensor : sonar.topic.sensors) {
    const RangeScan& scan = scans[sensor.index];
    poses.push_back(scan.X_RS);
    ranges.push_back(scan.ranges.front());
    limits.push_back(scan.limits.max);
  }
  dds::WireArena arena;
  sonar.points->Write(ros::MakePointCloud(Stamp(tick), frames_.base, poses, ranges, limits, arena));
}

void RobotOutput::PublishJoints(Tick tick, const RobotView& robot) {
  std::vector<ros::NamedJoint> joints;
  for (const ros::MovingFrame& frame : tree_.moving) {
    joints.push_back({frame.joint_name, robot.world_state().joints[frame.joint.index()]});
  }
  dds::WireArena arena;
  joint_states_->Write(ros::MakeJointState(Stamp(tick), joints, arena));
}

void RobotOutput::PublishBattery(Tick tick, const RobotView& robot) {
  const std::optional<std::size_t> store = scene_->store_of(description().root);
  if (!store || *store >= robot.world_state().stores.size()) return;
  dds::WireArena arena;
  battery_->Write(ros::MakeBatteryState(Stamp(tick), frames_.base,
                                        scene_->world().model(scene_->stores()[*store].model).power,
                                        robot.world_state().stores[*store], arena));
}

void RobotOutput::PublishLaser(Tick tick, const RobotView& robot, Laser& laser) {
  const auto& [ranger, sensor, topic, frame] = laser.topic;
  if (!laser.writer->is_addressed() || !Due(tick, ranger)) return;
  const double period = description().sensors[ranger].period_ticks * scene_->world().interval_seconds();
  dds::WireArena arena;
  laser.writer->Write(ros::MakeLaserScan(Stamp(tick), frames_.prefix + frame, ScansOf(robot, ranger)[sensor], period,
                                         infinite_ranges_, arena));
}

void RobotOutput::PublishSonar(Tick tick, const RobotView& robot, Sonar& sonar) {
  const std::size_t ranger = sonar.topic.ranger;
  const bool wanted = sonar.writer ? sonar.writer->is_addressed() : sonar.humble_writer->is_addressed();
  if (!wanted || !Due(tick, ranger)) return;
  const std::vector<RangeScan>& scans = ScansOf(robot, ranger);
  for (const ros::SonarTopic::Sensor& sensor : sonar.topic.sensors) {
    dds::WireArena arena;
    const ros::RangeMessage message =
        ros::MakeRange(Stamp(tick), frames_.prefix + sensor.frame, scans[sensor.index], arena);
    if (sonar.writer) {
      sonar.writer->Write(message);
    } else {
      sonar.humble_writer->Write(ros::WithoutVariance(message));
    }
  }
}

std::vector<ros::TransformStamped> RobotOutput::MovingTransforms(Tick tick, const RobotView& robot,
                                                                 dds::WireArena& arena) const {
  std::vector<ros::TransformStamped> transforms;
  if (odom_to_base_) {
    transforms.push_back(ros::MakeTransform(Stamp(tick), frames_.odom, frames_.base, robot.pose_estimate(), arena));
  }
  for (const ros::MovingFrame& frame : tree_.moving) {
    const Pose pose = ros::X_PF(frame, scene_->world(), robot.world_state().joints[frame.joint.index()].position);
    transforms.push_back(ros::MakeTransform(Stamp(tick), frame.parent, frame.frame, pose, arena));
  }
  return transforms;
}

std::vector<ros::TransformStamped> RobotOutput::StaticTransforms(const RobotView& robot, dds::WireArena& arena) const {
  std::vector<ros::TransformStamped> transforms;
  for (const ros::FixedFrame& frame : tree_.fixed) {
    transforms.push_back(ros::MakeTransform(Stamp(0), frame.parent, frame.frame, frame.X_PF, arena));
  }
  sensors_.AddOpticalTransforms(Stamp(0), transforms, arena);
  // A name that the configurations of Nav2 expect: the base on the ground.
  if (frames_.prefix.empty()) {
    transforms.push_back(ros::MakeTransform(Stamp(0), frames_.base, ros::kFootprintFrame, {}, arena));
  }
  if (map_to_odom_) {
    const Pose X_WO = ros::OdomInMap(description().localization, robot.state().X_WR, robot.pose_estimate());
    transforms.push_back(ros::MakeTransform(Stamp(0), ros::kMapFrame, frames_.odom, X_WO, arena));
  }
  return transforms;
}

}  // namespace troupe
