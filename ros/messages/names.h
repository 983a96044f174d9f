// The names of robots, sensors, joints and grippers in ROS: functions of the world alone, so that all processes agree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ros/messages/ros_options.h"
#include "troupe/result.h"
#include "troupe/world_description.h"

namespace troupe::ros {

// `text` as a valid part of a topic name: letters, digits and single underscores, the first not a digit.
std::string RosName(const std::string& text);

// The name of each robot as RosName, with a number appended where two would be equal; a name that is valid as it is
// stays. "" for a removed robot whose name another robot has now.
std::vector<std::string> RobotNames(const WorldDescription& world);

// The frames of one robot, as tf calls them.
struct FrameNames {
  std::string odom;
  std::string base;
  std::string prefix;  // of all other frames
};
inline constexpr const char* kBaseFrame = "base_link";

// `prefixed`: "<robot>/odom"; otherwise "odom". `base`: of the robot, without a prefix.
FrameNames FramesOf(const std::string& robot, bool prefixed, const std::string& base = kBaseFrame);

// The base of a robot in tf, without its prefix: the first of its frames, or kBaseFrame.
std::string BaseFrameOf(const RobotDescription& robot);

// Whether the robot has a frame of that name, from its URDF or SDF.
bool HasFrame(const RobotDescription& robot, const std::string& name);

inline constexpr const char* kMapFrame = "map";
inline constexpr const char* kFootprintFrame = "base_footprint";

// A ray sensor of many rays: a LaserScan topic of its own.
struct LaserTopic {
  std::size_t ranger = 0;  // in RobotDescription::sensors
  std::size_t sensor = 0;  // in RangerParameters::ray_sensors
  std::string topic;       // below the robot's namespace
  std::string frame;       // without the robot's prefix
};

// The sensors of one ray of one ranger: they share a Range topic, and each has a frame.
struct SonarTopic {
  struct Sensor {
    std::size_t index = 0;  // in RangerParameters::ray_sensors
    std::string frame;
  };
  std::size_t ranger = 0;
  std::string topic;
  std::vector<Sensor> sensors;
};

// A ray sensor with several planes: a cloud of points on the topic "<topic>/points".
struct CloudTopic {
  std::size_t ranger = 0;
  std::size_t sensor = 0;  // in RangerParameters::ray_sensors
  std::string topic;
  std::string frame;
};

// A sensor of another kind. A camera has topics below its name, "<topic>/image_raw" and so on; a fiducial finder and a
// blobfinder have "<topic>/detections"; a bumper and a contact sensor have one that says whether they are pressed; a
// radio has "<topic>/send" and "<topic>/received", an IMU "<topic>/data". Other kinds have none.
struct KindTopic {
  std::size_t sensor = 0;  // in RobotDescription::sensors
  std::string topic;
  std::string frame;  // looking along x; the images of a camera are in "<frame>_optical". "": none
};

struct SensorTopics {
  std::vector<LaserTopic> lasers;
  std::vector<SonarTopic> sonars;
  std::vector<CloudTopic> clouds;
  std::vector<KindTopic> cameras;
  std::vector<KindTopic> finders;  // of fiducials
  std::vector<KindTopic> blobfinders;
  std::vector<KindTopic> touches;
  std::vector<KindTopic> radios;
  std::vector<KindTopic> imus;
};

// A topic has the name of its ranger. A ranger without a name of its own ("ranger:0") is called "scan", or "sonar" if
// all its sensors have one ray; a number distinguishes further ones. Sensors of other kinds in the same way: "camera".
SensorTopics SensorTopicsOf(const RobotDescription& robot);

// The name of a joint in joint_states and in the robot's URDF, and the frame of the link that it moves.
struct JointName {
  JointId joint;
  std::string name;   // without the robot's prefix, like the frame
  std::string frame;  // "<name>_link"
};
// In id order. The names differ from the names of the sensors' mounts ("<frame>_mount"), the frames from the sensors'.
std::vector<JointName> JointNamesOf(const WorldDescription& world, RobotId robot);

// The name of a gripper in topics, as in "<name>/command". No joint of the robot has the same name.
struct GripperName {
  GripperId gripper;
  std::string name;
};
std::vector<GripperName> GripperNamesOf(const WorldDescription& world, RobotId robot);

// RobotInRos: where a robot appears in ROS: its domain, and the names of its topics and frames there.
struct RobotInRos {
  std::uint32_t domain = 0;
  bool alone = false;          // in a domain of its own, apart from that of the run
  std::string name;            // as in RobotNames
  std::string node_namespace;  // "/anna", "/fleet/anna"; "/" if its names are plain
  FrameNames frames;
};

// A robot with a ROS domain has plain names, and so has the first robot of the run's domain if `names` asks for it.
RobotInRos FindRobotInRos(const WorldDescription& world, RobotId robot, std::uint32_t run_domain,
                          const RosNames& names);

// All robots that are there.
std::vector<std::pair<RobotId, RobotInRos>> FindRobotsInRos(const WorldDescription& world, std::uint32_t run_domain,
                                                            const RosNames& names);

// One line for each robot whose topics are below another name than its own, because that is none of ROS; of many
// robots, for the first ones.
std::vector<std::string> NoticesOfNames(const WorldDescription& world, std::uint32_t run_domain, const RosNames& names);

// The error is a robot in the domain of the simulation (nothing: the run uses no network), or plain names for several
// robots of one domain.
Status CheckDomains(const WorldDescription& world, std::uint32_t run_domain, const RosNames& names,
                    std::optional<std::uint32_t> simulation_domain);

// True for "/fleet/anna": a slash before each part, which begins with a letter and has letters, digits and single
// underscores.
bool IsNamespace(const std::string& text);

}  // namespace troupe::ros
