#include "common/ros/robot_description.h"

#include <fmt/format.h>

namespace troupe::ros {
namespace {

// In XML.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string Origin(const Pose& pose) {
  return fmt::format(R"(<origin xyz="{:.6g} {:.6g} {:.6g}" rpy="0 0 {:.6g}"/>)", pose.x, pose.y, pose.z, pose.heading);
}

// A box around an outline in its model's frame.
std::string Visual(const Block& block, const Pose& X_RM, const std::string& material) {
  Rectangle around = Rectangle::Nothing();
  for (const Vec2& corner : block.outline) around.Extend(corner);
  const Vec2 center = around.center();
  const Pose X_MB{center.x(), center.y(), 0.5 * (block.z.min + block.z.max), 0.0};
  return fmt::format(
      "    <visual>{}<geometry><box size=\"{:.6g} {:.6g} {:.6g}\"/></geometry><material name=\"{}\"/></visual>\n",
      Origin(X_RM * X_MB), around.width(), around.height(), block.z.max - block.z.min, material);
}

std::string FixedLink(const std::string& frame, const std::string& parent, const Pose& pose) {
  return fmt::format(
      "  <link name=\"{0}\"/>\n  <joint name=\"{0}_mount\" type=\"fixed\"><parent link=\"{1}\"/><child "
      "link=\"{0}\"/>{2}"
      "</joint>\n",
      Escaped(frame), Escaped(parent), Origin(pose));
}

}  // namespace

std::string MakeRobotDescription(const Scene& scene, RobotId robot, const std::string& name, const FrameNames& frames) {
  const WorldDescription& world = scene.world();
  std::string materials;
  std::string visuals;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelId model(i);
    if (scene.robot_of(model) != robot || world.shape(world.model(model).shape).blocks.empty()) continue;
    const Color& color = world.model(model).color;
    const std::string material = fmt::format("material_{}", i);
    materials += fmt::format("  <material name=\"{}\"><color rgba=\"{:.4g} {:.4g} {:.4g} {:.4g}\"/></material>\n",
                             material, color.r, color.g, color.b, color.a);
    for (const Block& block : world.shape(world.model(model).shape).blocks) {
      visuals += Visual(block, scene.X_RM(model), material);
    }
  }
  std::string links;
  const auto add_sensor = [&](std::size_t ranger, std::size_t sensor, const std::string& frame) {
    const RangerDescription& description = world.robot(robot).rangers[ranger];
    const Pose X_RS = scene.X_RM(description.model) * description.sensors[sensor].X_MS;
    links += FixedLink(frames.prefix + frame, frames.base, X_RS);
  };
  const SensorTopics sensors = SensorTopicsOf(world.robot(robot));
  for (const LaserTopic& laser : sensors.lasers) add_sensor(laser.ranger, laser.sensor, laser.frame);
  for (const SonarTopic& sonar : sensors.sonars) {
    for (const SonarTopic::Sensor& sensor : sonar.sensors) add_sensor(sonar.ranger, sensor.index, sensor.frame);
  }
  return fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n{}  <link name=\"{}\">\n{}  </link>\n{}</robot>\n",
                     Escaped(name), materials, Escaped(frames.base), visuals, links);
}

}  // namespace troupe::ros
