// Names: what robots and sensors are called in ROS. A function of the world alone, so that every process agrees.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/model/world_description.h"

namespace troupe::ros {

// `text` as ROS takes it for a part of a topic: letters, digits and single underscores, not beginning with a digit.
std::string RosName(const std::string& text);

// By robot: its name as RosName, with a number behind where two would be the same.
std::vector<std::string> RobotNames(const WorldDescription& world);

// The frames of one robot, as tf calls them.
struct FrameNames {
  std::string odom;
  std::string base;
  std::string prefix;  // of all other frames
};
// `prefixed`: "<robot>/odom"; otherwise "odom".
FrameNames FramesOf(const std::string& robot, bool prefixed);

inline constexpr const char* kMapFrame = "map";

// A ray sensor of many rays: a LaserScan topic of its own.
struct LaserTopic {
  std::size_t ranger = 0;  // in RobotDescription::rangers
  std::size_t sensor = 0;  // in RangerDescription::sensors
  std::string topic;       // below the robot's namespace
  std::string frame;       // without the robot's prefix
};

// The sensors of one ray of one ranger: they share a Range topic, and each has a frame.
struct SonarTopic {
  struct Sensor {
    std::size_t index = 0;  // in RangerDescription::sensors
    std::string frame;
  };
  std::size_t ranger = 0;
  std::string topic;
  std::vector<Sensor> sensors;
};

struct SensorTopics {
  std::vector<LaserTopic> lasers;
  std::vector<SonarTopic> sonars;
};

// Topics are named after the ranger. One that has no name of its own ("ranger:0") is "scan", or "sonar" when it has
// sensors of one ray only; further ones get a number.
SensorTopics SensorTopicsOf(const RobotDescription& robot);

// What a joint is called in joint_states and in the robot's URDF, and the frame of what it moves.
struct JointName {
  JointId joint;
  std::string name;   // without the robot's prefix, like the frame
  std::string frame;  // "<name>_link"
};
// In id order. No name is one of a sensor's mount ("<frame>_mount"), and no frame one of a sensor.
std::vector<JointName> JointNamesOf(const WorldDescription& world, RobotId robot);

// What a gripper is called in topics: "<name>/command". No joint of the robot has that name.
struct GripperName {
  GripperId gripper;
  std::string name;
};
std::vector<GripperName> GripperNamesOf(const WorldDescription& world, RobotId robot);

}  // namespace troupe::ros
