// A ROS domain of this test process' own, on the loopback interface.
#pragma once

#include <unistd.h>

#include "common/ros/ros_options.h"

namespace troupe::test {

inline ros::RosOptions TestRosOptions() {
  ros::RosOptions options;
  options.domain = 1 + static_cast<std::uint32_t>(getpid()) % 99;  // TestDomain() begins at 100
  options.network_interface = "lo";
  return options;
}

}  // namespace troupe::test
