// The configurations of viewers for a world: what RViz and Foxglove show of it without a click.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ros/messages/ros_options.h"
#include "troupe/world_description.h"

namespace troupe {

inline constexpr std::size_t kMostShownRobots = 50;  // with displays of their own: RViz draws no more in time

// A configuration of RViz 2 (YAML): the map, and of each robot of the domain of the run its model, odometry, scans,
// clouds and pictures; the tools are sent to the first robot. `left_out`: the names of the robots that it has not.
std::string RvizText(const WorldDescription& world, std::uint32_t domain, const ros::RosNames& names,
                     std::vector<std::string>& left_out);

// A layout of Foxglove or Lichtblick (JSON) for the live connection and exported recordings: the scene with all
// scans, the events, and a plot of the speeds of up to eight robots.
std::string FoxgloveLayoutText(const WorldDescription& world);

}  // namespace troupe
