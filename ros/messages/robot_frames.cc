#include "ros/messages/robot_frames.h"

#include "common/model/model_poses.h"

namespace troupe::ros {
namespace {

// The pose of a sensor's frame on its model; of a ranger, that of one of its ray sensors.
Pose PoseOnModel(const SensorDescription& description, std::size_t ray_sensor) {
  if (const auto* const camera = std::get_if<CameraParameters>(&description.parameters)) return camera->X_MS;
  if (const auto* const finder = std::get_if<FiducialParameters>(&description.parameters)) return finder->X_MS;
  if (const auto* const finder = std::get_if<BlobfinderParameters>(&description.parameters)) return finder->X_MS;
  if (const auto* const imu = std::get_if<ImuParameters>(&description.parameters)) return imu->X_MS;
  return std::get<RangerParameters>(description.parameters).ray_sensors[ray_sensor].X_MS;
}

}  // namespace

RobotFrames RobotFramesOf(const Scene& scene, RobotId robot, const FrameNames& names) {
  const Body& body = scene.body(scene.body_of(robot));
  RobotFrames frames;
  frames.links.resize(body.links.size(), names.base);
  std::vector<std::string> joint_names(body.links.size());
  for (const JointName& joint : JointNamesOf(scene.world(), robot)) {
    const std::uint32_t link = scene.link_of(joint.joint);
    frames.links[link] = names.prefix + joint.frame;
    joint_names[link] = joint.name;
  }
  for (std::size_t i = 1; i < body.links.size(); ++i) {
    const Link& link = body.links[i];
    frames.moving.push_back({*link.joint, joint_names[i], frames.links[link.parent], frames.links[i], link.X_PL});
  }
  const auto add_sensor = [&](std::size_t ranger, std::size_t sensor, const std::string& frame) {
    const SensorDescription& description = scene.world().robot(robot).sensors[ranger];
    const Pose X_LS = scene.X_LM(description.model) * PoseOnModel(description, sensor);
    frames.fixed.push_back({frames.links[scene.link_of(description.model)], names.prefix + frame, X_LS});
  };
  const SensorTopics sensors = SensorTopicsOf(scene.world().robot(robot));
  for (const LaserTopic& laser : sensors.lasers) add_sensor(laser.ranger, laser.sensor, laser.frame);
  for (const CloudTopic& cloud : sensors.clouds) add_sensor(cloud.ranger, cloud.sensor, cloud.frame);
  for (const KindTopic& camera : sensors.cameras) add_sensor(camera.sensor, 0, camera.frame);
  for (const KindTopic& finder : sensors.finders) add_sensor(finder.sensor, 0, finder.frame);
  for (const KindTopic& finder : sensors.blobfinders) add_sensor(finder.sensor, 0, finder.frame);
  for (const KindTopic& imu : sensors.imus) add_sensor(imu.sensor, 0, imu.frame);
  for (const SonarTopic& sonar : sensors.sonars) {
    for (const SonarTopic::Sensor& sensor : sonar.sensors) add_sensor(sonar.ranger, sensor.index, sensor.frame);
  }
  return frames;
}

Pose X_PF(const MovingFrame& frame, const WorldDescription& world, double position) {
  return frame.X_PF * JointMotion(world.joint(frame.joint), position);
}

}  // namespace troupe::ros
