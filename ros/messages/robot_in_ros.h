// RobotInRos: where a robot appears in ROS: its domain, and the names of its topics and frames there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ros/messages/names.h"
#include "ros/messages/ros_options.h"
#include "troupe/result.h"
#include "troupe/world_description.h"

namespace troupe::ros {

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
