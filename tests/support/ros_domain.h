// A ROS domain that only this test process uses, on the loopback interface.
#pragma once

#include "ros/messages/ros_options.h"
#include "tests/support/reserved_domain.h"

namespace troupe::test {

inline ros::RosOptions TestRosOptions() {
  ros::RosOptions options;
  static const std::uint32_t domain = ReserveDomain();
  options.domain = domain;
  options.network_interface = "lo";
  return options;
}

}  // namespace troupe::test
