#include "ros/messages/robot_frames.h"

#include <fmt/format.h>

#include "common/model/states.h"

namespace troupe::ros {
namespace {

// The pose of a sensor's frame on its model; of a ranger, that of one of its ray sensors.
Pose PoseOnModel(const SensorDescription& description, std::size_t ray_sensor) {
  if (const auto* const camera = std::get_if<CameraParameters>(&description.parameters)) return camera->X_MS;
  if (const auto* const finder = std::get_if<FiducialParameters>(&description.parameters)) return finder->X_MS;
  if (const auto* const finder = std::get_if<BlobfinderParameters>(&description.parameters)) return finder->X_MS;
  if (const auto* const imu = std::get_if<ImuParameters>(&description.parameters)) return imu->X_MS;
  return (*std::get<RangerParameters>(description.parameters).ray_sensors)[ray_sensor].X_MS;
}

// URDF has roll, pitch and yaw in rad.
std::string Origin(const Pose& pose, double roll = 0.0, double pitch = 0.0) {
  return fmt::format(R"(<origin xyz="{:.6g} {:.6g} {:.6g}" rpy="{:.6g} {:.6g} {:.6g}"/>)", pose.x, pose.y, pose.z, roll,
                     pitch, pose.heading);
}

// A box around an outline in its model's frame.
std::string Visual(const Block& block, const Pose& X_LM, const std::string& material) {
  Rectangle around = Rectangle::Nothing();
  for (const Vec2& corner : block.outline) around.Extend(corner);
  const Vec2 center = around.center();
  const Pose X_MB{center.x(), center.y(), 0.5 * (block.z.min + block.z.max), 0.0};
  return fmt::format(
      "    <visual>{}<geometry><box size=\"{:.6g} {:.6g} {:.6g}\"/></geometry><material name=\"{}\"/></visual>\n",
      Origin(X_LM * X_MB), around.width(), around.height(), block.z.max - block.z.min, material);
}

std::string FixedJoint(const FixedFrame& frame) {
  return fmt::format(
      "  <link name=\"{0}\"/>\n  <joint name=\"{0}_mount\" type=\"fixed\"><parent link=\"{1}\"/><child "
      "link=\"{0}\"/>{2}</joint>\n",
      frame.frame, frame.parent, Origin(frame.X_PF, frame.roll, frame.pitch));
}

// Forces are not simulated, so an effort of 0 limits nothing.
std::string MovingJoint(const MovingFrame& frame, const JointDescription& joint) {
  return fmt::format(
      "  <joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>{}<axis xyz=\"{:.6g} {:.6g} "
      "{:.6g}\"/><limit lower=\"{:.6g}\" upper=\"{:.6g}\" velocity=\"{:.6g}\" effort=\"0\"/></joint>\n",
      frame.joint_name, NameOf(joint.type), frame.parent, frame.frame, Origin(frame.X_PF), joint.axis_xy.x(),
      joint.axis_xy.y(), joint.axis_z, joint.position.min, joint.position.max, joint.max_speed);
}

}  // namespace

// The tree of tf: a frame for each link and each sensor. Names are the same in tf, URDF and headers of messages.
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
  const RobotDescription& own = scene.world().robot(robot);
  for (std::size_t i = 1; i < own.frames.size(); ++i) {
    const MountedFrame& frame = own.frames[i];
    frames.fixed.push_back({frames.links[scene.link_of(frame.model)], names.prefix + frame.name,
                            scene.X_LM(frame.model) * frame.X_MF, frame.roll, frame.pitch});
  }
  const auto add_sensor = [&](std::size_t ranger, std::size_t sensor, const std::string& frame) {
    if (HasFrame(own, frame)) return;
    const SensorDescription& description = own.sensors[ranger];
    const Pose X_LS = scene.X_LM(description.model) * PoseOnModel(description, sensor);
    frames.fixed.push_back({frames.links[scene.link_of(description.model)], names.prefix + frame, X_LS});
  };
  const SensorTopics sensors = SensorTopicsOf(own);
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

// URDF with boxes around the blocks: enough for a viewer, and without files that another host lacks.
std::string MakeRobotDescription(const Scene& scene, RobotId robot, const std::string& name, const FrameNames& names) {
  const WorldDescription& world = scene.world();
  const RobotFrames frames = RobotFramesOf(scene, robot, names);
  std::string materials;
  std::vector<std::string> visuals(frames.links.size());  // by link
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelId model(i);
    if (scene.robot_of(model) != robot || world.shape(world.model(model).shape).blocks.empty()) continue;
    const Color& color = world.model(model).color;
    const std::string material = fmt::format("material_{}", i);
    materials += fmt::format("  <material name=\"{}\"><color rgba=\"{:.4g} {:.4g} {:.4g} {:.4g}\"/></material>\n",
                             material, color.r, color.g, color.b, color.a);
    for (const Block& block : world.shape(world.model(model).shape).blocks) {
      visuals[scene.link_of(model)] += Visual(block, scene.X_LM(model), material);
    }
  }
  std::string links;
  for (std::size_t i = 0; i < frames.links.size(); ++i) {
    links += fmt::format("  <link name=\"{}\">\n{}  </link>\n", frames.links[i], visuals[i]);
  }
  for (const MovingFrame& frame : frames.moving) links += MovingJoint(frame, world.joint(frame.joint));
  for (const FixedFrame& frame : frames.fixed) links += FixedJoint(frame);
  return fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n{}{}</robot>\n", name, materials, links);
}

}  // namespace troupe::ros
