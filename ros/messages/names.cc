#include "ros/messages/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/base/text.h"

namespace troupe::ros {
namespace {

// ASCII only, in any locale.
bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}
bool IsAlphanumeric(char c) {
  return IsDigit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

// Gives each name once: a name in use gets the first number from 1 on that makes it unique.
class UniqueNames {
 public:
  std::string Reserve(const std::string& name) {
    std::string unique = name;
    for (int number = 1; !used_.insert(unique).second; ++number) unique = name + "_" + std::to_string(number);
    return unique;
  }

 private:
  std::set<std::string> used_;
};

// "ranger:0": the name of a model that the world file gives none.
bool IsAutomatic(const std::string& name) {
  const std::size_t colon = name.rfind(':');
  return colon != std::string::npos && colon + 1 < name.size() &&
         std::all_of(name.begin() + static_cast<std::ptrdiff_t>(colon) + 1, name.end(), IsDigit);
}

bool IsLaser(const RaySensorDescription& sensor) {
  return sensor.samples > 1 || !sensor.elevations.empty();
}

// The names of topics that tools expect (scan, sonar) where the file gives none.
std::string BaseName(const std::string& name, const RangerParameters& ranger) {
  if (!IsAutomatic(name)) return RosName(name);
  return std::any_of(ranger.ray_sensors->begin(), ranger.ray_sensors->end(), IsLaser) ? "scan" : "sonar";
}

// The robot with plain names where --ros-names plain is set; robots with a domain of their own always have them.
std::optional<RobotId> FirstOfRun(const WorldDescription& world) {
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (!world.robots[i].ros.domain && RobotExists(world, RobotId(i))) return RobotId(i);
  }
  return std::nullopt;
}

// `name`: of the robot, as in RobotNames.
RobotInRos Find(const WorldDescription& world, RobotId robot, const std::string& name, bool is_first_of_run,
                std::uint32_t run_domain, const RosNames& names) {
  const RosIdentity& identity = world.robot(robot).ros;
  RobotInRos found;
  found.domain = identity.domain.value_or(run_domain);
  found.alone = found.domain != run_domain;
  found.name = name;
  const bool is_plain = identity.domain || (names.plain && is_first_of_run);
  if (is_plain) {
    found.node_namespace = "/";
  } else {
    found.node_namespace = IsNamespace(identity.name_space) ? identity.name_space : "/" + found.name;
  }
  found.frames =
      FramesOf(found.node_namespace.substr(1), !names.namespaced_tf && !is_plain, BaseFrameOf(world.robot(robot)));
  return found;
}

// Frames of its URDF or SDF are there whatever its sensors are called.
void ReserveFrames(const RobotDescription& robot, UniqueNames& frames) {
  for (const char* reserved : {"odom", kBaseFrame, kFootprintFrame, kMapFrame}) frames.Reserve(reserved);
  for (const MountedFrame& frame : robot.frames) frames.Reserve(frame.name);
}

// The frame of a sensor's messages. `otherwise`: of one whose description names none.
std::string SensorFrame(const RobotDescription& robot, const SensorDescription& sensor, const std::string& otherwise,
                        UniqueNames& frames) {
  if (sensor.frame.empty()) return frames.Reserve(otherwise);
  return HasFrame(robot, sensor.frame) ? sensor.frame : frames.Reserve(sensor.frame);
}

}  // namespace

// Letters, digits and single underscores, beginning with a letter: ROS allows no other names of topics.
std::string RosName(const std::string& text) {
  std::string name;
  for (const char c : text) {
    if (IsAlphanumeric(c)) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  if (name.empty()) return "unnamed";
  return IsDigit(name.front()) ? "n" + name : name;
}

// Names that are valid as they are come first, so that no other robot takes them.
std::vector<std::string> RobotNames(const WorldDescription& world) {
  UniqueNames unique;
  std::vector<std::string> names(world.robots.size());
  for (const bool is_valid : {true, false}) {
    for (std::size_t i = 0; i < world.robots.size(); ++i) {
      const std::string& name = world.robots[i].name;
      if ((RosName(name) == name) != is_valid) continue;
      // A removed robot keeps its name, so that the names of others stay, until another robot has the same one.
      const bool is_replaced = !RobotExists(world, RobotId(i)) && FindRobot(world, name);
      if (!is_replaced) names[i] = unique.Reserve(RosName(name));
    }
  }
  return names;
}

FrameNames FramesOf(const std::string& robot, bool prefixed, const std::string& base) {
  const std::string prefix = prefixed ? robot + "/" : "";
  return {.odom = prefix + "odom", .base = prefix + base, .prefix = prefix};
}

std::string BaseFrameOf(const RobotDescription& robot) {
  return robot.frames.empty() ? kBaseFrame : robot.frames.front().name;
}

bool HasFrame(const RobotDescription& robot, const std::string& name) {
  return std::any_of(robot.frames.begin(), robot.frames.end(),
                     [&](const MountedFrame& frame) { return frame.name == name; });
}

// In the order of the description, so that names do not change from run to run. Topics and frames have name spaces of
// their own.
SensorTopics SensorTopicsOf(const RobotDescription& robot) {
  SensorTopics topics;
  UniqueNames names;
  UniqueNames frames;
  for (const char* reserved : {"cmd_vel", "odom", "ground_truth", "stalled", "tf", "tf_static", "joint_states",
                               "battery", "robot_description"}) {
    names.Reserve(reserved);
  }
  ReserveFrames(robot, frames);
  const auto frame_of = [&](std::size_t sensor, const std::string& otherwise) {
    return SensorFrame(robot, robot.sensors[sensor], otherwise, frames);
  };
  for (std::size_t r = 0; r < robot.sensors.size(); ++r) {
    const RangerParameters* const ranger = std::get_if<RangerParameters>(&robot.sensors[r].parameters);
    if (ranger == nullptr) {
      const std::string type(TypeOf(robot.sensors[r].parameters));
      const bool is_camera = type == CameraParameters::kType;
      const bool is_radio = type == RadioParameters::kType;
      const bool is_imu = type == ImuParameters::kType;
      const bool is_finder = type == FiducialParameters::kType;
      const bool is_blobfinder = type == BlobfinderParameters::kType;
      const bool is_touch = type == BumperParameters::kType || type == ContactParameters::kType;
      if (!is_camera && !is_finder && !is_blobfinder && !is_touch && !is_radio && !is_imu) continue;
      const std::string kind_base = IsAutomatic(robot.sensors[r].name) ? type : RosName(robot.sensors[r].name);
      std::string topic = names.Reserve(kind_base);
      if (is_camera) {
        std::string frame = frame_of(r, kind_base);
        frames.Reserve(frame + "_optical");
        topics.cameras.push_back({r, std::move(topic), std::move(frame)});
      } else if (is_radio) {
        topics.radios.push_back({r, std::move(topic), ""});
      } else if (is_imu) {
        topics.imus.push_back({r, std::move(topic), frame_of(r, kind_base)});
      } else if (is_finder || is_blobfinder) {
        std::vector<KindTopic>& kind = is_finder ? topics.finders : topics.blobfinders;
        kind.push_back({r, std::move(topic), frame_of(r, kind_base)});
      } else {
        topics.touches.push_back({r, std::move(topic), ""});
      }
      continue;
    }
    const std::string base = BaseName(robot.sensors[r].name, *ranger);
    SonarTopic sonar{.ranger = r, .topic = "", .sensors = {}};
    for (std::size_t s = 0; s < ranger->ray_sensors->size(); ++s) {
      // Several sensors of one ranger have frames of their own, because they are at different places.
      const std::string frame =
          ranger->ray_sensors->size() > 1 ? frames.Reserve(base + "_" + std::to_string(s)) : frame_of(r, base);
      if (!(*ranger->ray_sensors)[s].elevations.empty()) {
        topics.clouds.push_back({r, s, names.Reserve(base), frame});
      } else if (IsLaser((*ranger->ray_sensors)[s])) {
        topics.lasers.push_back({r, s, names.Reserve(base), frame});
      } else {
        sonar.sensors.push_back({s, frame});
      }
    }
    if (sonar.sensors.empty()) continue;
    const bool mixed = sonar.sensors.size() < ranger->ray_sensors->size();
    sonar.topic = names.Reserve(mixed ? base + "_ranges" : base);
    topics.sonars.push_back(std::move(sonar));
  }
  return topics;
}

namespace {

// A URDF or SDF file has one name space of joints, whatever carries them here.
std::string JointNameInFile(const RobotDescription& robot, const std::string& name) {
  return robot.frames.empty() ? name : name.substr(name.rfind('.') + 1);
}

}  // namespace

// Joints come after the sensors, whose frames are the more common names.
std::vector<JointName> JointNamesOf(const WorldDescription& world, RobotId robot) {
  UniqueNames names;
  UniqueNames frames;
  ReserveFrames(world.robot(robot), frames);
  const auto reserve_sensor = [&](const std::string& frame) {
    frames.Reserve(frame);
    names.Reserve(frame + "_mount");
  };
  const SensorTopics sensors = SensorTopicsOf(world.robot(robot));
  for (const LaserTopic& laser : sensors.lasers) reserve_sensor(laser.frame);
  for (const CloudTopic& cloud : sensors.clouds) reserve_sensor(cloud.frame);
  for (const KindTopic& camera : sensors.cameras) {
    reserve_sensor(camera.frame);
    frames.Reserve(camera.frame + "_optical");
  }
  for (const KindTopic& finder : sensors.finders) reserve_sensor(finder.frame);
  for (const KindTopic& finder : sensors.blobfinders) reserve_sensor(finder.frame);
  for (const KindTopic& imu : sensors.imus) reserve_sensor(imu.frame);
  for (const SonarTopic& sonar : sensors.sonars) {
    for (const SonarTopic::Sensor& sensor : sonar.sensors) reserve_sensor(sensor.frame);
  }
  std::vector<JointName> joints;
  for (std::size_t i = 0; i < world.joints.size(); ++i) {
    if (world.joints[i].robot != robot) continue;
    const std::string name = names.Reserve(RosName(JointNameInFile(world.robot(robot), world.joints[i].name)));
    joints.push_back({JointId(i), name, frames.Reserve(name + "_link")});
  }
  return joints;
}

std::vector<GripperName> GripperNamesOf(const WorldDescription& world, RobotId robot) {
  UniqueNames names;
  for (const JointName& joint : JointNamesOf(world, robot)) names.Reserve(joint.name);
  std::vector<GripperName> grippers;
  for (std::size_t i = 0; i < world.grippers.size(); ++i) {
    if (world.grippers[i].robot != robot) continue;
    grippers.push_back({GripperId(i), names.Reserve(RosName(world.grippers[i].name))});
  }
  return grippers;
}

// "/a/b": a slash before each part, and none at the end.
bool IsNamespace(const std::string& text) {
  if (!text.starts_with("/")) return false;
  for (std::size_t start = 1; start <= text.size();) {
    const std::size_t end = std::min(text.find('/', start), text.size());
    const std::string part = text.substr(start, end - start);
    if (part.empty() || RosName(part) != part) return false;
    start = end + 1;
  }
  return text.size() > 1;
}

// In one domain, the types of the simulation and those of ROS would be discovered by tools of the other.
Status CheckDomains(const WorldDescription& world, std::uint32_t run_domain, const RosNames& names,
                    std::optional<std::uint32_t> simulation_domain) {
  if (simulation_domain == run_domain) {
    return Error{{},
                 fmt::format("found {} as the domain of the run and as its ROS domain, expected two: see --domain and "
                             "--ros-domain",
                             run_domain)};
  }
  std::size_t of_run = 0;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const RobotDescription& robot = world.robots[i];
    if (!RobotExists(world, RobotId(i))) continue;
    if (!robot.ros.domain) ++of_run;
    if (robot.ros.domain && robot.ros.domain == simulation_domain) {
      return Error{{},
                   fmt::format("found the ROS domain {} for robot '{}', which is the domain of the simulation, "
                               "expected another one, or another --domain",
                               *robot.ros.domain, robot.name)};
    }
  }
  if (!names.plain || of_run <= 1) return Status();
  return Error{{},
               fmt::format("found --ros-names plain for {} robots in one ROS domain, expected one robot, or a "
                           "ros_domain for each",
                           of_run)};
}

RobotInRos FindRobotInRos(const WorldDescription& world, RobotId robot, std::uint32_t run_domain,
                          const RosNames& names) {
  return Find(world, robot, RobotNames(world)[robot.index()], FirstOfRun(world) == robot, run_domain, names);
}

std::vector<std::pair<RobotId, RobotInRos>> FindRobotsInRos(const WorldDescription& world, std::uint32_t run_domain,
                                                            const RosNames& names) {
  const std::vector<std::string> robot_names = RobotNames(world);
  const std::optional<RobotId> first = FirstOfRun(world);
  std::vector<std::pair<RobotId, RobotInRos>> found;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const RobotId robot(i);
    if (!RobotExists(world, robot)) continue;
    found.emplace_back(robot, Find(world, robot, robot_names[i], first == robot, run_domain, names));
  }
  return found;
}

// A user who looks for a robot's topics by its name must learn of another one.
std::vector<std::string> NoticesOfNames(const WorldDescription& world, std::uint32_t run_domain,
                                        const RosNames& names) {
  constexpr std::size_t kMaxNotices = 10;
  std::vector<std::string> notices;
  std::size_t more = 0;
  for (const auto& [robot, found] : FindRobotsInRos(world, run_domain, names)) {
    const std::string& name = world.robot(robot).name;
    if (found.name == name || found.node_namespace != "/" + found.name) continue;
    if (notices.size() == kMaxNotices) {
      ++more;
      continue;
    }
    const bool is_taken = RosName(name) != found.name;
    notices.push_back(fmt::format("the topics of robot '{}' are below /{}: {}", PlainLine(name, 200), found.name,
                                  is_taken ? "another robot has its name as ROS would spell it"
                                           : "names in ROS have letters, digits and single underscores"));
  }
  if (more > 0) notices.push_back(fmt::format("{} more robots have other names in ROS than in the world", more));
  return notices;
}

}  // namespace troupe::ros
