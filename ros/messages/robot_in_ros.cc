#include "ros/messages/robot_in_ros.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "common/base/utf8.h"

namespace troupe::ros {
namespace {

std::optional<RobotId> FirstOfRun(const WorldDescription& world) {
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (!world.robots[i].ros.domain && IsThere(world, RobotId(i))) return RobotId(i);
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
  found.frames = FramesOf(found.node_namespace.substr(1), !names.namespaced_tf && !is_plain);
  return found;
}

}  // namespace

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
    if (!IsThere(world, RobotId(i))) continue;
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
    if (!IsThere(world, robot)) continue;
    found.emplace_back(robot, Find(world, robot, robot_names[i], first == robot, run_domain, names));
  }
  return found;
}

std::vector<std::string> NoticesOfNames(const WorldDescription& world, std::uint32_t run_domain,
                                        const RosNames& names) {
  constexpr std::size_t kMost = 10;
  std::vector<std::string> notices;
  std::size_t more = 0;
  for (const auto& [robot, found] : FindRobotsInRos(world, run_domain, names)) {
    const std::string& name = world.robot(robot).name;
    if (found.name == name || found.node_namespace != "/" + found.name) continue;
    if (notices.size() == kMost) {
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
