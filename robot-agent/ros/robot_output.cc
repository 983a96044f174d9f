#include "robot-agent/ros/robot_output.h"

#include <algorithm>
#include <utility>

#include "ros/connection/ros_network.h"

namespace troupe {
namespace {

constexpr std::int32_t kOutputDepth = 10;

// REQUIRES: sensor `ranger` is a ranger.
const RangerReading& ReadingOf(const RobotView& robot, std::size_t ranger) {
  return std::get<RangerReading>(robot.Measure(ranger).content);
}

constexpr std::int32_t kSensorDepth = 10;
constexpr std::int32_t kImageDepth = 2;  // images are large

// Whether a bumper or contact sensor touches something.
bool IsPressed(const SensorReading& reading) {
  if (const ContactReading* const contact = reading.As<ContactReading>()) return !contact->contacts.empty();
  const BumperReading* const bumper = reading.As<BumperReading>();
  return bumper != nullptr &&
         std::any_of(bumper->segments.begin(), bumper->segments.end(),
                     [](const BumperReading::Segment& segment) { return segment.pressed_by.has_value(); });
}

}  // namespace

// Writers exist from the start, so that tools see the topics; samples are made only for readers.
RobotOutput::RobotOutput(const ros::RosNode& node, const ros::RobotTopics& settings, const Scene& scene, RobotId robot,
                         const ros::RobotInRos& in_ros)
    : connection_(*node.connection),
      scene_(&scene),
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

// In every tick, whether or not the odometry has a reader: its covariance grows with the way.
void RobotOutput::AddMotion(const RobotView& robot) {
  odometry_error_.AddMotion(robot.state().twist, scene_->world().interval_seconds());
}

bool RobotOutput::IsNew(std::optional<Motion>& last, Tick tick, const RobotView& robot) const {
  const Motion motion{tick, robot.pose_estimate(), robot.state().twist};
  // The same pose of the same tick is not written twice, such as by a repetition in a pause.
  return std::exchange(last, motion) != motion || connection_.addresses_newcomers();
}

// A topic without a reader costs one test.
void RobotOutput::Publish(Tick tick, const RobotView& robot) {
  const RobotState& state = robot.state();
  if (odom_.is_addressed() && IsNew(last_odometry_, tick, robot)) {
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

// A sonar's ranges as points, for costmaps that know no Range messages.
void RobotOutput::PublishPoints(Tick tick, const RobotView& robot, Sonar& sonar) {
  const std::size_t ranger = sonar.topic.ranger;
  if (!sonar.points->is_addressed() || !Due(tick, ranger)) return;
  const RangerReading& reading = ReadingOf(robot, ranger);
  std::vector<Pose> poses;
  std::vector<double> ranges;
  std::vector<double> limits;
  for (const ros::SonarTopic::Sensor& sensor : sonar.topic.sensors) {
    const RangeScan scan = reading.scan(sensor.index);
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
  laser.writer->Write(ros::MakeLaserScan(Stamp(tick), frames_.prefix + frame, ReadingOf(robot, ranger).scan(sensor),
                                         period, infinite_ranges_, arena));
}

void RobotOutput::PublishSonar(Tick tick, const RobotView& robot, Sonar& sonar) {
  const std::size_t ranger = sonar.topic.ranger;
  const bool wanted = sonar.writer ? sonar.writer->is_addressed() : sonar.humble_writer->is_addressed();
  if (!wanted || !Due(tick, ranger)) return;
  const RangerReading& reading = ReadingOf(robot, ranger);
  for (const ros::SonarTopic::Sensor& sensor : sonar.topic.sensors) {
    dds::WireArena arena;
    const ros::RangeMessage message =
        ros::MakeRange(Stamp(tick), frames_.prefix + sensor.frame, reading.scan(sensor.index), arena);
    if (sonar.writer) {
      sonar.writer->Write(message);
    } else {
      sonar.humble_writer->Write(ros::WithoutVariance(message));
    }
  }
}

// odom to base, and the links that joints move.
std::vector<ros::TransformStamped> RobotOutput::MovingTransforms(Tick tick, const RobotView& robot,
                                                                 dds::WireArena& arena) {
  std::vector<ros::TransformStamped> transforms;
  if (!IsNew(last_transforms_, tick, robot)) return transforms;
  if (odom_to_base_) {
    transforms.push_back(ros::MakeTransform(Stamp(tick), frames_.odom, frames_.base, robot.pose_estimate(), arena));
  }
  for (const ros::MovingFrame& frame : tree_.moving) {
    const Pose pose = ros::X_PF(frame, scene_->world(), robot.world_state().joints[frame.joint.index()].position);
    transforms.push_back(ros::MakeTransform(Stamp(tick), frame.parent, frame.frame, pose, arena));
  }
  return transforms;
}

// Stamped with 0: they hold at any time.
std::vector<ros::TransformStamped> RobotOutput::StaticTransforms(const RobotView& robot, dds::WireArena& arena) const {
  std::vector<ros::TransformStamped> transforms;
  for (const ros::FixedFrame& frame : tree_.fixed) {
    transforms.push_back(ros::MakeTransform(Stamp(0), frame, arena));
  }
  sensors_.AddOpticalTransforms(Stamp(0), transforms, arena);
  // A name that the configurations of Nav2 expect: the base on the ground.
  if (frames_.prefix.empty() && !ros::HasFrame(description(), ros::kFootprintFrame)) {
    transforms.push_back(ros::MakeTransform(Stamp(0), frames_.base, ros::kFootprintFrame, {}, arena));
  }
  if (map_to_odom_) {
    const Pose X_WO = ros::OdomInMap(description().localization, robot.state().X_WR, robot.pose_estimate());
    transforms.push_back(ros::MakeTransform(Stamp(0), ros::kMapFrame, frames_.odom, X_WO, arena));
  }
  return transforms;
}

SensorOutput::SensorOutput(const ros::RosNode& node, const Scene& scene, RobotId robot, const ros::FrameNames& frames)
    : scene_(&scene), id_(robot), prefix_(frames.prefix) {
  const ros::SensorTopics topics = ros::SensorTopicsOf(scene.world().robot(robot));
  const ros::TopicQos images = ros::Stream(kImageDepth);
  for (const ros::KindTopic& topic : topics.cameras) {
    Camera camera{topic, nullptr, nullptr, nullptr, nullptr};
    camera.colors = std::make_unique<ros::RosWriter<ros::ImageMessage>>(node, topic.topic + "/image_raw", images);
    camera.info = std::make_unique<ros::RosWriter<ros::CameraInfo>>(node, topic.topic + "/camera_info", images);
    camera.depths = std::make_unique<ros::RosWriter<ros::ImageMessage>>(node, topic.topic + "/depth/image_raw", images);
    camera.depth_info =
        std::make_unique<ros::RosWriter<ros::CameraInfo>>(node, topic.topic + "/depth/camera_info", images);
    cameras_.push_back(std::move(camera));
  }
  for (const ros::CloudTopic& topic : topics.clouds) {
    clouds_.push_back({topic, std::make_unique<ros::RosWriter<ros::PointCloud2>>(node, topic.topic + "/points",
                                                                                 ros::Stream(kImageDepth))});
  }
  const ros::TopicQos stream = ros::Stream(kSensorDepth);
  for (const ros::KindTopic& topic : topics.finders) {
    finders_.push_back(
        {topic, std::make_unique<ros::RosWriter<ros::Detection3dArray>>(node, topic.topic + "/detections", stream)});
  }
  for (const ros::KindTopic& topic : topics.blobfinders) {
    blobfinders_.push_back(
        {topic, std::make_unique<ros::RosWriter<ros::Detection2dArray>>(node, topic.topic + "/detections", stream)});
  }
  for (const ros::KindTopic& topic : topics.touches) {
    touches_.push_back({topic, std::make_unique<ros::RosWriter<ros::Bool>>(node, topic.topic, stream)});
  }
  for (const ros::KindTopic& topic : topics.imus) {
    imus_.push_back({topic, std::make_unique<ros::RosWriter<ros::ImuMessage>>(node, topic.topic + "/data", stream)});
  }
}

bool SensorOutput::Due(Tick tick, std::size_t sensor) const {
  return tick % scene_->world().robot(id_).sensors[sensor].period_ticks == 0;
}

void SensorOutput::Publish(const ros::Time& stamp, Tick tick, const RobotView& robot) {
  for (Camera& camera : cameras_) {
    if (Due(tick, camera.topic.sensor)) PublishCamera(stamp, robot, camera);
  }
  for (Cloud& cloud : clouds_) {
    if (!cloud.writer->is_addressed() || !Due(tick, cloud.topic.ranger)) continue;
    dds::WireArena arena;
    cloud.writer->Write(ros::MakeScanCloud(stamp, prefix_ + cloud.topic.frame,
                                           ReadingOf(robot, cloud.topic.ranger).scan(cloud.topic.sensor), arena));
  }
  for (Finder& finder : finders_) {
    if (!finder.writer->is_addressed() || !Due(tick, finder.topic.sensor)) continue;
    const auto& reading = std::get<FiducialReading>(robot.Measure(finder.topic.sensor).content);
    dds::WireArena arena;
    finder.writer->Write(
        ros::MakeFiducialDetections(stamp, prefix_ + finder.topic.frame, scene_->world(), reading, arena));
  }
  for (BlobOutput& finder : blobfinders_) {
    if (!finder.writer->is_addressed() || !Due(tick, finder.topic.sensor)) continue;
    const auto& reading = std::get<BlobfinderReading>(robot.Measure(finder.topic.sensor).content);
    dds::WireArena arena;
    finder.writer->Write(ros::MakeBlobDetections(stamp, prefix_ + finder.topic.frame, reading, arena));
  }
  for (TouchOutput& touch : touches_) {
    if (!touch.writer->is_addressed() || !Due(tick, touch.topic.sensor)) continue;
    touch.writer->Write({IsPressed(robot.Measure(touch.topic.sensor))});
  }
  for (ImuOutput& imu : imus_) {
    if (!imu.writer->is_addressed() || !Due(tick, imu.topic.sensor)) continue;
    const auto& reading = std::get<ImuReading>(robot.Measure(imu.topic.sensor).content);
    dds::WireArena arena;
    imu.writer->Write(ros::MakeImuMessage(stamp, prefix_ + imu.topic.frame, reading, arena));
  }
}

// One measurement for all four topics of a camera.
void SensorOutput::PublishCamera(const ros::Time& stamp, const RobotView& robot, Camera& camera) {
  if (!camera.colors->is_addressed() && !camera.info->is_addressed() && !camera.depths->is_addressed() &&
      !camera.depth_info->is_addressed()) {
    return;
  }
  const CameraReading& reading = std::get<CameraReading>(robot.Measure(camera.topic.sensor).content);
  const std::string frame = OpticalFrame(camera);
  dds::WireArena arena;
  if (camera.colors->is_addressed()) camera.colors->Write(ros::MakeColorImage(stamp, frame, reading, arena));
  if (camera.depths->is_addressed()) camera.depths->Write(ros::MakeDepthImage(stamp, frame, reading, arena));
  if (camera.info->is_addressed()) camera.info->Write(ros::MakeCameraInfo(stamp, frame, reading, arena));
  if (camera.depth_info->is_addressed()) camera.depth_info->Write(ros::MakeCameraInfo(stamp, frame, reading, arena));
}

void SensorOutput::AddOpticalTransforms(const ros::Time& stamp, std::vector<ros::TransformStamped>& transforms,
                                        dds::WireArena& arena) const {
  for (const Camera& camera : cameras_) {
    transforms.push_back(ros::MakeOpticalTransform(stamp, prefix_ + camera.topic.frame, OpticalFrame(camera), arena));
  }
}

}  // namespace troupe
