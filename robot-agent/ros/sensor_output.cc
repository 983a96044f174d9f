#include "robot-agent/ros/sensor_output.h"

#include <algorithm>
#include <utility>

#include "ros/connection/ros_qos.h"
#include "ros/messages/convert_sensors.h"

namespace troupe {
namespace {

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
    const SensorReading& reading = robot.Measure(cloud.topic.ranger);
    dds::WireArena arena;
    cloud.writer->Write(ros::MakeScanCloud(stamp, prefix_ + cloud.topic.frame,
                                           std::get<RangerReading>(reading.content).scans[cloud.topic.sensor], arena));
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
