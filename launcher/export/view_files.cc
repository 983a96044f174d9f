#include "launcher/export/view_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "ros/messages/names.h"
#include "troupe/rectangle.h"
#include "viewer/foxglove/messages.h"

namespace troupe {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPlots = 8;

// A display of RViz: `more` are lines of its own, which begin with six blanks.
std::string Display(const std::string& type, const std::string& name, const std::string& topic, const char* durability,
                    const char* reliability, const std::string& more = "") {
  return fmt::format(
      "    - Class: rviz_default_plugins/{}\n      Name: {}\n      Enabled: true\n      Value: true\n{}      Topic:\n  "
      "      Value: {}\n"
      "        Depth: 5\n        Durability Policy: {}\n        History Policy: Keep Last\n        Reliability Policy: "
      "{}\n",
      type, name, more, topic, durability, reliability);
}

// As of ROS's names: below the namespace of the robot.
std::string TopicOf(const ros::RobotInRos& robot, const std::string& topic) {
  return (robot.node_namespace == "/" ? "" : robot.node_namespace) + "/" + topic;
}

std::string RobotDisplays(const RobotDescription& robot, const ros::RobotInRos& in_ros) {
  const std::string description = TopicOf(in_ros, "robot_description");
  std::string text = fmt::format(
      "    - Class: rviz_default_plugins/RobotModel\n      Name: {}\n      Enabled: true\n      Value: true\n"
      "      Description Source: Topic\n      Description Topic:\n        Value: {}\n        Depth: 1\n"
      "        Durability Policy: Transient Local\n        History Policy: Keep Last\n        Reliability Policy: "
      "Reliable\n",
      in_ros.name + " model", description);
  text += Display("Odometry", in_ros.name + " odometry", TopicOf(in_ros, "odom"), "Volatile", "Reliable",
                  "      Keep: 1\n      Covariance:\n        Value: false\n");
  const ros::SensorTopics topics = ros::SensorTopicsOf(robot);
  for (const ros::LaserTopic& laser : topics.lasers) {
    text += Display("LaserScan", in_ros.name + " " + laser.topic, TopicOf(in_ros, laser.topic), "Volatile",
                    "Best Effort", "      Size (m): 0.03\n      Style: Flat Squares\n");
  }
  for (const ros::CloudTopic& cloud : topics.clouds) {
    text += Display("PointCloud2", in_ros.name + " " + cloud.topic, TopicOf(in_ros, cloud.topic + "/points"),
                    "Volatile", "Best Effort", "      Size (m): 0.03\n      Style: Flat Squares\n");
  }
  for (const ros::KindTopic& camera : topics.cameras) {
    text += Display("Image", in_ros.name + " " + camera.topic, TopicOf(in_ros, camera.topic + "/image_raw"), "Volatile",
                    "Best Effort");
  }
  return text;
}

// The whole world from above: its middle, and its larger side in m.
std::pair<Vec2, double> ViewOf(const WorldDescription& world) {
  Rectangle box = Rectangle::Nothing();
  for (const ModelDescription& model : world.models) {
    if (model.removed || model.parent) continue;
    const double reach = 0.5 * std::max(model.size_x, model.size_y);
    box.Extend(model.X_PM.translation() - Vec2(reach, reach));
    box.Extend(model.X_PM.translation() + Vec2(reach, reach));
  }
  if (!(box.min_x <= box.max_x)) return {Vec2(0.0, 0.0), 10.0};
  return {0.5 * Vec2(box.min_x + box.max_x, box.min_y + box.max_y),
          std::max({box.max_x - box.min_x, box.max_y - box.min_y, 1.0})};
}

}  // namespace

std::string RvizText(const WorldDescription& world, std::uint32_t domain, const ros::RosNames& names,
                     std::vector<std::string>& left_out) {
  std::string robots;
  std::string first = "/";
  std::size_t count = 0;
  for (const auto& [robot, in_ros] : ros::FindRobotsInRos(world, domain, names)) {
    if (in_ros.alone || in_ros.domain != domain || count == kMostShownRobots) {
      left_out.push_back(world.robot(robot).name);
      continue;
    }
    if (count++ == 0) first = TopicOf(in_ros, "");
    robots += RobotDisplays(world.robot(robot), in_ros);
  }
  const auto [middle, size] = ViewOf(world);
  std::string text =
      "Panels:\n  - Class: rviz_common/Displays\n    Name: Displays\n  - Class: rviz_common/Views\n    Name: Views\n"
      "  - Class: rviz_common/Time\n    Name: Time\n    SyncMode: 0\nVisualization Manager:\n  Class: \"\"\n  "
      "Displays:\n"
      "    - Class: rviz_default_plugins/Grid\n      Name: Grid\n      Enabled: true\n      Value: true\n";
  text += Display("Map", "Map", "/map", "Transient Local", "Reliable", "      Alpha: 0.7\n      Color Scheme: map\n");
  text += "    - Class: rviz_default_plugins/TF\n      Name: TF\n      Enabled: false\n      Value: false\n";
  text += robots;
  text +=
      "  Enabled: true\n  Global Options:\n    Fixed Frame: map\n    Frame Rate: 30\n  Tools:\n"
      "    - Class: rviz_default_plugins/MoveCamera\n    - Class: rviz_default_plugins/Select\n";
  for (const auto& [tool, topic] : {std::pair{"SetInitialPose", "initialpose"}, std::pair{"SetGoal", "goal_pose"}}) {
    text += fmt::format(
        "    - Class: rviz_default_plugins/{}\n      Topic:\n        Value: {}{}\n        Depth: 5\n"
        "        Durability Policy: Volatile\n        History Policy: Keep Last\n        Reliability Policy: "
        "Reliable\n",
        tool, first, topic);
  }
  // Pixels for a metre, in a window of usual size.
  text += fmt::format(
      "  Views:\n    Current:\n      Class: rviz_default_plugins/TopDownOrtho\n      Name: Current View\n"
      "      Angle: 0\n      Scale: {:.3f}\n      X: {:.3f}\n      Y: {:.3f}\n      Target Frame: map\n    Saved: ~\n",
      600.0 / size, middle.x(), middle.y());
  return text;
}

std::string FoxgloveLayoutText(const WorldDescription& world) {
  Json topics = Json::object();
  for (const foxglove::Channel& channel : foxglove::ChannelsOf(world)) {
    if (channel.kind == foxglove::ChannelKind::kScene || channel.kind == foxglove::ChannelKind::kScan) {
      topics[channel.topic] = {{"visible", true}};
    }
    if (channel.kind == foxglove::ChannelKind::kMap) topics[channel.topic] = {{"visible", false}};
  }
  const auto [middle, size] = ViewOf(world);
  Json paths = Json::array();
  for (const RobotDescription& robot : world.robots) {
    if (paths.size() == kMostPlots) break;
    // A name with a quote has no form in the paths of messages.
    if (robot.name.find('"') != std::string::npos) continue;
    paths.push_back({{"value", "/tables/robots.rows[:]{name==\"" + robot.name + "\"}.speed"},
                     {"label", robot.name},
                     {"enabled", true},
                     {"timestampMethod", "receiveTime"}});
  }
  const Json layout = {
      {"configById",
       {{"3D!scene",
         {{"followTf", "map"},
          {"followMode", "follow-none"},
          {"topics", std::move(topics)},
          {"transforms", Json::object()},
          {"cameraState",
           {{"perspective", true},
            {"distance", 1.2 * size},
            {"phi", 35},
            {"thetaOffset", 0},
            {"targetOffset", {middle.x(), middle.y(), 0}},
            {"target", {0, 0, 0}},
            {"targetOrientation", {0, 0, 0, 1}},
            {"fovy", 45},
            {"near", 0.1},
            {"far", 5000}}}}},
        {"RosOut!events", {{"topicToRender", "/events"}, {"minLogLevel", 1}, {"searchTerms", Json::array()}}},
        {"Plot!speeds",
         {{"paths", std::move(paths)}, {"showLegend", true}, {"isSynced", true}, {"xAxisVal", "timestamp"}}}}},
      {"globalVariables", Json::object()},
      {"userNodes", Json::object()},
      {"playbackConfig", {{"speed", 1}}},
      {"layout",
       {{"direction", "row"},
        {"first", "3D!scene"},
        {"second",
         {{"direction", "column"}, {"first", "Plot!speeds"}, {"second", "RosOut!events"}, {"splitPercentage", 50}}},
        {"splitPercentage", 65}}},
  };
  return layout.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace troupe
